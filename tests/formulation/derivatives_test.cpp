#include "formulation/derivatives_suite.hpp"

#include "formulation/balance_suite.hpp"

#include "formulation/patch_suite.hpp"

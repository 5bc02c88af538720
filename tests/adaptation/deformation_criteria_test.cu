#include "adaptation/deformation_criteria_suite.hpp"

#include "adaptation/shape_criteria_suite.hpp"

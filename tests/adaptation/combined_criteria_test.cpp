#include "adaptation/combined_criteria_suite.hpp"

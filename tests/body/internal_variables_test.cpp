#include "body/internal_variables_suite.hpp"

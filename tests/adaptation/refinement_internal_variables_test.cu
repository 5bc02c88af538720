#include "adaptation/refinement_internal_variables_suite.hpp"

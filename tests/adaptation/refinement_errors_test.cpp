#include "adaptation/refinement_errors_suite.hpp"

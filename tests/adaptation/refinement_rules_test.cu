#include "adaptation/refinement_rules_suite.hpp"

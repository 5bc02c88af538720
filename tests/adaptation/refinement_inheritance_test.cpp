#include "adaptation/refinement_inheritance_suite.hpp"

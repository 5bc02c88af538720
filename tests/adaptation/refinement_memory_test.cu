#include "adaptation/refinement_memory_suite.hpp"

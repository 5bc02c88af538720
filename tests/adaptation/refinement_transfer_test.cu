#include "adaptation/refinement_transfer_suite.hpp"

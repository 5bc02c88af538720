#include "adaptation/rotation_criterion_suite.hpp"

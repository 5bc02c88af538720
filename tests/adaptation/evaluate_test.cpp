#include "adaptation/evaluate_suite.hpp"

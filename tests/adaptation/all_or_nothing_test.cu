#include "adaptation/all_or_nothing_suite.hpp"

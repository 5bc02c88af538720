#include "adaptation/other_elements_suite.hpp"

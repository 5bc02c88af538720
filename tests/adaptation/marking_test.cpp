#include "adaptation/marking_suite.hpp"

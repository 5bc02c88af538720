#include "adaptation/switching_statistics_suite.hpp"

#include "adaptation/switching_suite.hpp"

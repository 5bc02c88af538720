#include "body/archive_suite.hpp"

#include "body/history_suite.hpp"

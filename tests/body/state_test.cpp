#include "body/state_suite.hpp"

#include "body/conditions_suite.hpp"

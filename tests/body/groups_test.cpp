#include "body/groups_suite.hpp"

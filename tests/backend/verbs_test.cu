#include "backend/verbs_suite.hpp"

#include "law/user_law_suite.hpp"

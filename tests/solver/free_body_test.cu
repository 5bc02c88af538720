#include "solver/free_body_suite.hpp"

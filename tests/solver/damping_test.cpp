#include "solver/damping_suite.hpp"

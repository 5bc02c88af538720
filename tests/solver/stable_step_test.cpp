#include "solver/stable_step_suite.hpp"

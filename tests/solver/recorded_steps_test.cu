#include "solver/recorded_steps_suite.hpp"

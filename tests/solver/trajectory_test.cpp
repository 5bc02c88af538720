#include "solver/trajectory_suite.hpp"

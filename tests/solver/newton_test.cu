#include "solver/newton_suite.hpp"

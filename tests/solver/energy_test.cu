#include "solver/energy_suite.hpp"

#include "solver/integrators_suite.hpp"

#include "solver/newton_refined_suite.hpp"

#include "solver/lumped_bar_suite.hpp"

#include "solver/blow_up_suite.hpp"

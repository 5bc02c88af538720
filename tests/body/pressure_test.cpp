#include "body/pressure_suite.hpp"

#include "body/bad_input_suite.hpp"

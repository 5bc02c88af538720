#include "body/element_values_suite.hpp"

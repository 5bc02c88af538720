#include "adaptation/hanging_nodes_suite.hpp"

#include "adaptation/endurance_suite.hpp"

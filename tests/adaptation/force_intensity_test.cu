#include "adaptation/force_intensity_suite.hpp"

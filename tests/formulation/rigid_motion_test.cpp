#include "formulation/rigid_motion_suite.hpp"

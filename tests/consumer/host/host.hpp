#pragma once

#include <pliant/config.hpp>

inline int version_of_pliant() { return 100 * pliant::version.major + pliant::version.minor; }

// expect: -ffast-math .* switches off Pliant's checks
// flags: -O1 -ffast-math
#ifdef PLIANT_MISUSE_OFF
#define PLIANT_ALLOW_FAST_MATH
#endif
#include <pliant/mesh/mesh.hpp>

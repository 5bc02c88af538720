// expect: -ffinite-math-only.* switches off Pliant's checks
// flags: -ffinite-math-only
#include <pliant/mesh/mesh.hpp>

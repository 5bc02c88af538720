// expect: Gauss<n> on triangles is exact for degree n = 1 to 6
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Ruled = Formulation<Tri3, Gauss<7>, Hooke>;
#else
using Ruled = Formulation<Tri3, Gauss<4>, Hooke>;
#endif

static_assert(Ruled::nodes == 3);

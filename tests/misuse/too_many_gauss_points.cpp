// expect: Gauss<n> has 1 to 10 points per direction
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Ruled = Formulation<Hex8, Gauss<11>, Hooke>;
#else
using Ruled = Formulation<Hex8, Gauss<4>, Hooke>;
#endif

static_assert(Ruled::nodes == 8);

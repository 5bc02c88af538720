// expect: Gauss<n> on quadrilaterals and hexahedra has 1 to 4 points per direction
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Exact = Formulation<Hex8, Gauss<5>, Hooke>;
#else
using Exact = Formulation<Hex8, Gauss<4>, Hooke>;
#endif

static_assert(Exact::nodes == 8);

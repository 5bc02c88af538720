// expect: Lobatto<n> is a rule for quadrilaterals and hexahedra; take Gauss<n> or Exact
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Nodal3 = Formulation<Tet10, Lobatto<3>, Hooke>;
#else
using Nodal3 = Formulation<Hex27, Lobatto<3>, Hooke>;
#endif

static_assert(Nodal3::dim == 3);

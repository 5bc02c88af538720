// expect: this quadrature has too few points for this element
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Loose = Formulation<Hex8, Gauss<1>, Hooke>;
#else
using Loose = Formulation<Hex8, OnePoint, Hooke>;
#endif

static_assert(Loose::nodes == 8);

// expect: refine: available for the catalogue's elements, pyramids aside
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Tet4, Gauss<1>, Hooke>;
using Pyramids = Formulation<Pyramid5, Gauss<2>, Hooke>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = when<Pyramids>(Rotation{}).above(0.1).refine();
#else
auto const rule = when<Linear>(Rotation{}).above(0.1).refine();
#endif

int main() {}

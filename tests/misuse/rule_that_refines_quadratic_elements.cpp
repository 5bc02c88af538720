// expect: refine: available for Tri3 and Quad4
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Quadratic = Formulation<Quad9, Gauss<3>, Hooke>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = when<Quadratic>(Rotation{}).above(0.1).refine();
#else
auto const rule = when<Linear>(Rotation{}).above(0.1).refine();
#endif

int main() {}

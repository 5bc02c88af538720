// expect: split: for Quad4, Hex8 and Pyramid5 elements
#include <pliant/pliant.hpp>

using namespace pliant;

using Triangles = Formulation<Tri3, Gauss<1>, Hooke>;
using Quads = Formulation<Quad4, Gauss<2>, Hooke>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = when<Triangles>(Rotation{}).above(0.1).split();
#else
auto const rule = when<Quads>(Rotation{}).above(0.1).split();
#endif

int main() {}

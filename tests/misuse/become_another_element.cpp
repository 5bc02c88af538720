// expect: From and To must be formulations on the same element
#include <pliant/pliant.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = when<Quads>(Rotation{}).above(0.1).become<Triangles>();
#else
auto const rule = when<Quads>(Rotation{}).above(0.1).become<Rubber>();
#endif

int main() {}

// expect: a choice is among formulations on one element
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = cheapest<Linear, Triangles>({.tolerance = 1e-6});
#else
auto const rule = cheapest<Linear, Rubber>({.tolerance = 1e-6});
#endif

int main() {}

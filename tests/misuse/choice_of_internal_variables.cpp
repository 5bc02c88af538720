// expect: a choice is among groups with the same internal variables, or none
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Hex8, Gauss<2>, Hooke>;
using Rubber = Formulation<Hex8, Gauss<2>, NeoHookean>;
using Slow = Formulation<Hex8, Gauss<2>, Prony<NeoHookean>::law>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = cheapest<Linear, Slow>({.tolerance = 1e-6});
#else
auto const rule = cheapest<Linear, Rubber>({.tolerance = 1e-6});
#endif

int main() {}

// expect: rules that switch or change the mesh go into another Adaptation
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

auto const choice = cheapest<Linear, Rubber>({.tolerance = 1e-6});
#ifndef PLIANT_MISUSE_OFF
Adaptation const adapt{choice, when<Linear>(Rotation{}).above(0.1).become<Rubber>()};
#else
Adaptation const adapt{choice, sleep({.below = 1e-3})};
#endif

int main() {}

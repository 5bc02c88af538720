// expect: a choice is among two groups or more
#include <pliant/pliant.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

#ifndef PLIANT_MISUSE_OFF
auto const rule = within<Rubber>({.error = 1e-3});
#else
auto const rule = within<Linear, Rubber>({.error = 1e-3});
#endif

int main() {}

// expect: laws with internal variables take quadratures whose points see their own deformation
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Q = FBar<Gauss<2>>;
#else
using Q = Gauss<2>;
#endif
using F = Formulation<Quad4, Q, Prony<NeoHookean>::law>;

int main() {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Group<F> const group{{{{3, 2}, {0.5}, {1}}}};
  Body body{Reference<double>{}, mesh, Elastic{5.2, 0.3, 1}, group};
}

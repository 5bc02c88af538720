// expect: this body has no Group<F>
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Linear>{}};
#ifndef PLIANT_MISUSE_OFF
  body.assign<Rubber>({0});
#else
  body.assign<Linear>({0});
#endif
}

// expect: Body
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

int main() {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
#ifndef PLIANT_MISUSE_OFF
  int backend = 0;
#else
  Reference<double> backend;
#endif
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Linear>{}};
}

// expect: element_steps<E>: the body's mesh does not have this element type
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Quads>{}};
#ifndef PLIANT_MISUSE_OFF
  (void)element_steps<Tri3>(body);
#else
  (void)element_steps<Quad4>(body);
#endif
}

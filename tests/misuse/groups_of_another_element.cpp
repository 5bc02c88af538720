// expect: groups are asked for an element type that the body's mesh does not have
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Quads>{}};
#ifndef PLIANT_MISUSE_OFF
  (void)body.groups_of<Tri3>();
#else
  (void)body.groups_of<Quad4>();
#endif
}

// expect: every Group is of an element type that the mesh has
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;
using Triangles = Formulation<Tri3, Gauss<1>, Hooke>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Elastic const rubber{1, 0.3, 1};
#ifndef PLIANT_MISUSE_OFF
  Body body{backend, mesh, rubber, Group<Quads>{}, Group<Triangles>{}};
#else
  Body body{backend, mesh, rubber, Group<Quads>{}};
#endif
}

// expect: F is for an element type that the body's mesh does not have
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;
using Triangles = Formulation<Tri3, Gauss<1>, Hooke>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Quads>{}};
#ifndef PLIANT_MISUSE_OFF
  body.assign<Triangles>({0});
#else
  body.assign<Quads>({0});
#endif
}

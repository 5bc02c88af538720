// expect: refinement is available for plane meshes of Tri3 and Quad4
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using F = Formulation<Quad9, Gauss<3>, Hooke>;
#else
using F = Formulation<Quad4, Gauss<2>, Hooke>;
#endif

int main() {
  auto const mesh = mesh::rectangle<F::element>({.size = {1, 1}, .cells = {1, 1}});
  Body body{Reference<double>{}, mesh, Elastic{1, 0.3, 1}, Group<F>{}};
  refine(body, {{0}});
}

// expect: meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using F = Formulation<Pyramid5, Gauss<2>, Hooke>;
#else
using F = Formulation<Hex27, Gauss<3>, Hooke>;
#endif

int main() {
  auto const mesh = mesh::box<F::element>({.size = {1, 1, 1}, .cells = {1, 1, 1}});
  Body body{Reference<double>{}, mesh, Elastic{1, 0.3, 1}, Group<F>{}};
  refine(body, {{0}});
}

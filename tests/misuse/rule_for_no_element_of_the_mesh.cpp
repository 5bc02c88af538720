// expect: a rule is for an element type that the body's mesh does not have
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Triangles = Formulation<Tri3, Gauss<1>, Hooke>;
using RubberTriangles = Formulation<Tri3, Gauss<1>, NeoHookean>;

int main() {
  Reference<double> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Linear>{}, Group<Rubber>{}};
#ifndef PLIANT_MISUSE_OFF
  Adaptation adapt{when<Triangles>(Rotation{}).above(0.1).become<RubberTriangles>()};
#else
  Adaptation adapt{when<Linear>(Rotation{}).above(0.1).become<Rubber>()};
#endif
  adapt(body);
}

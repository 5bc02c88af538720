// expect: every element type of the mesh needs a Group
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;
using Triangles = Formulation<Tri3, Gauss<1>, Hooke>;

int main() {
  Reference<double> backend;
  Mesh<Tri3, Quad4> mesh;
  mesh.nodes = {{0, 0}, {1, 0}, {0, 1}};
  mesh.elements<Tri3>() = {{0, 1, 2}};
  Elastic const rubber{1, 0.3, 1};
#ifndef PLIANT_MISUSE_OFF
  Body body{backend, mesh, rubber, Group<Quads>{}};
#else
  Body body{backend, mesh, rubber, Group<Quads>{}, Group<Triangles>{}};
#endif
}

#include <cmath>
#include <cstdio>
#include <vector>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#include <pliant/solve.hpp>

// A bar that its end is pulled along comes to rest where theory says.
int main() {
  using namespace pliant;
  using Material = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {10, 1}});
  Body body{Reference<double>{}, mesh, Elastic{.young = 1e6, .poisson = 0, .density = 1e3},
            Group<Material>{}};
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"), [](double) { return Point<2>{0.01, 0}; });
  auto const report = solve_static(body);
  std::vector<double> u;
  for (auto const& node : body.displacements()) u.insert(u.end(), {node[0], node[1]});
  double const energy = body.energy(u.data());
  double const expected = 0.5 * 1e6 * 0.1 * 0.01 * 0.01;  // J
  std::printf("%d factorisation, strain energy %g J\n", report.factorisations, energy);
  return std::abs(energy - expected) < 1e-9 * expected ? 0 : 1;
}

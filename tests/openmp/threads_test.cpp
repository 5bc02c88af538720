#include <pliant/solve.hpp>

#include "support/flat.hpp"
#include "support/formulations.hpp"

// What only the OpenMP backend promises: the same bits for any number of threads.
namespace pliant::test {

using Linear = Formulation<Tri3, Gauss<1>, Hooke>;
using Rubber = Formulation<Tri3, Gauss<1>, NeoHookean>;

struct Results {
  FieldOf<2> forces, tangent, moved, speeds;
  double energy, kinetic, stable;
  bool operator==(Results const&) const = default;
};

/// Everything that a body of triangles in two groups computes, many patches of them.
template <class T>
Results compute(int threads) {
  auto const mesh = distorted_mesh<Tri3>(64);
  REQUIRE(mesh.elements<Tri3>().size() > 3 * 2048);
  Body body{OpenMP<T>{{.threads = threads}}, mesh, soft, Group<Linear>{}, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -1});
  std::vector<Index> some;
  Random random(3);
  for (Index e = 0; e < static_cast<Index>(mesh.elements<Tri3>().size()); ++e)
    if (random.below(3) == 0) some.push_back(e);
  body.template assign<Rubber>(some);
  auto const u = random.field<2>(mesh.nodes.size(), 1e-3);
  Results r;
  r.forces = forces_at(body, u);
  r.tangent = tangent_product(body, u, random.field<2>(mesh.nodes.size(), 1.0));
  r.energy = strain_energy(body);
  r.stable = stable_step(body);
  CentralDifference step{};
  step(body, 20);
  r.moved = body.displacements();
  r.speeds = body.velocities();
  r.kinetic = kinetic_energy(body);
  return r;
}

TEMPLATE_TEST_CASE("results have the same bits for any number of threads", "[openmp]", float,
                   double) {
  Results const one = compute<TestType>(1);
  CHECK(largest(one.forces) > 0);
  for (int threads : {2, 3, 7}) {
    INFO(threads << " threads");
    CHECK((compute<TestType>(threads) == one));
  }
  CHECK((compute<TestType>(3) == one));  // and each time
}

TEST_CASE("a negative number of threads is refused", "[openmp]") {
  CHECK_THROWS_WITH(OpenMP<double>({.threads = -1}), says("-1 threads"));
  CHECK(OpenMP<double>({.threads = 3}).threads() == 3);
  CHECK(OpenMP<double>{}.threads() >= 1);
}

TEST_CASE("equilibria have the same bits for any number of threads", "[openmp]") {
  using Solid = Formulation<Hex8, Gauss<2>, NeoHookean>;
  auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {12, 12, 12}});
  auto const solve = [&](int threads) {
    Body body{OpenMP<double>{{.threads = threads}}, mesh, Elastic{1e6, 0.3, 1000}, Group<Solid>{}};
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, 0, -1});
    auto const report = solve_static(body);
    CHECK(report.linear.method == LinearMethod::multilevel);
    return std::pair{report.energy, body.displacements()};
  };
  auto const one = solve(1);
  CHECK(one.first > 0);
  CHECK(solve(2) == one);
  CHECK(solve(5) == one);
}

}  // namespace pliant::test

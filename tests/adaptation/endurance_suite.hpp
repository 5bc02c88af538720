#pragma once

#include "adaptation/plane_bodies.hpp"

namespace pliant::test::endurance_suite {

struct Tally {
  std::size_t refined = 0, switched = 0;
};

template <class TheBody>
void switch_some(TheBody& body, Random& random, Tally& tally) {
  auto const marks = random_marks(body, random, 10);
  put(body, marks, random.below(2) == 0 ? Put::linear : Put::rubber);
  for (auto const& list : marks) tally.switched += list.size();
}

template <class B, class M>
void live(B const& backend, M const& mesh, unsigned seed, Tally& tally) {
  INFO("seed " << seed);
  auto body = plane_body(backend, mesh);
  Random random(seed);
  body.set_velocities(random.field<2>(mesh.nodes.size(), 0.02));
  Point<2> const p = momentum(body);
  CentralDifference step;
  int const rounds = 12;
  for (int k = 1; k <= rounds; ++k) {
    INFO("round " << k);
    tally.refined += refine(body, random_marks(body, random, 40), 4).refined;
    switch_some(body, random, tally);
    step(body, 2);

    auto const hanging = hanging_nodes(body.mesh());
    REQUIRE(hanging);  // neighbours within one level
    check(body.mesh());
    std::vector<bool> hangs(static_cast<std::size_t>(body.nodes()), false);
    for (auto const& h : *hanging) hangs[static_cast<std::size_t>(h.node)] = true;
    bool masses = true;
    for (std::size_t i = 0; i < hangs.size(); ++i)
      masses = masses && (hangs[i] ? body.parts().layout.mass_list()[i] == 0
                                   : body.parts().layout.mass_list()[i] > 0);
    CHECK(masses);
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    REQUIRE(std::isfinite(largest(body.displacements())));
    REQUIRE(std::isfinite(total_energy(body)));
    // Per round: velocities rounded when refined, forces in each of two steps. Speeds stay of order
    // 0.02, forces times step sizes too.
    double const rounding = 32 * k * epsilon_of<decltype(body)> * 0.02 * soft.density;
    Point<2> const now = momentum(body);
    for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(now[i] - p[i]) < rounding);
  }
  CHECK(step.retries() == 0);
}

TEST_CASE("thousands of refinements and switches leave valid bodies", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    Tally tally;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      if constexpr (runs_all<B>) {
        live(backend, distorted_mesh<Tri3>(5, seed), seed, tally);
        live(backend, distorted_mesh<Quad4>(6, seed), seed, tally);
      }
      live(backend, mixed_mesh(5, seed), seed, tally);
    }
    CHECK(tally.refined > (runs_all<B> ? 2000 : 500));
    CHECK(tally.switched > (runs_all<B> ? 2000 : 500));
  });
}

}  // namespace pliant::test::endurance_suite

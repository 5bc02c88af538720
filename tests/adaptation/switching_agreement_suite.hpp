#pragma once

#include "support/seed_scene.hpp"

// What another backend decides is what Reference decides.
namespace pliant::test::switching_agreement_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

template <class B, class Criterion>
void compare_decisions(B const& backend, Criterion const& criterion, double threshold) {
  using T = typename B::scalar;
  // Criteria are rounded to some ε; in single precision, of squares of displacements over edges.
  double const near = sizeof(T) == 4 ? 1e-4 : 1e-9;
  auto const mesh = distorted_mesh<Quad4>(16);
  int decided = 0, acted = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto const u = rounded<float>(Random(seed).field<2>(mesh.nodes.size(), 0.006));
    auto const decide = [&](auto const& on) {
      Body body{on, mesh, soft, Group<Linear>{}, Group<Turning>{}};
      body.set_displacements(u);
      Adaptation{when<Linear>(criterion).above(threshold).template become<Turning>()}.now(body);
      return body.template groups_of<Quad4>();
    };
    Body oracle{Reference<double>{}, mesh, soft, Group<Linear>{}, Group<Turning>{}};
    oracle.set_displacements(u);
    auto const value = evaluate<Quad4>(oracle, criterion);

    auto const groups = decide(backend), expected = decide(Reference<double>{});

    for (std::size_t e = 0; e < value.size(); ++e)
      if (std::abs(value[e] - threshold) > near * std::max(1.0, threshold)) {
        CHECK(groups[e] == expected[e]);
        ++decided;
        acted += expected[e];
      }
  }
  CHECK(decided > 20 * 230);
  CHECK(acted > 20 * 20);
  CHECK(acted < 20 * 220);
}

TEST_CASE("single precision decides alike", "[adaptation]") {
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    compare_decisions(backend, largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{}), 0.12);
    compare_decisions(backend, ForceIntensity<>{}, 0.02);
  });
}

TEST_CASE("all backends decide alike", "[adaptation]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    compare_decisions(backend, EdgeLengthRatio{}, 0.1);
    compare_decisions(backend, AreaRatio{}, 0.08);
    compare_decisions(backend, Rotation{}, 0.03);
    compare_decisions(backend, largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{}), 0.12);
    compare_decisions(backend, AspectRatio{}, 1.2);
    compare_decisions(backend, HarmonicMeanShape{}, 0.985);
    compare_decisions(backend, ForceIntensity<>{}, 0.02);
  });
}

TEST_CASE("replaying the decisions of Reference gives its trajectory", "[adaptation]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const make = [](auto const& on) {
      auto const mesh = seed_mesh<Quad4>();
      Body body{on, mesh, seed_material, Group<Linear>{}, Group<Turning>{}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -10});
      return body;
    };
    auto oracle = make(Reference<double>{});
    auto body = make(backend);
    auto const criterion = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
    Adaptation adapt{when<Linear>(criterion).above(0.05).template become<Turning>(),
                     when<Turning>(criterion).below(0.04).template become<Linear>()};
    CentralDifference step{{.step = 2e-4}}, other_step{{.step = 2e-4}};
    int moves = 0;
    for (int k = 0; k < 200; ++k) {
      step(oracle, 8);
      other_step(body, 8);
      auto const before = oracle.template groups_of<Quad4>();
      synchronize_velocities(oracle.parts());  // as moving elements by hand does
      adapt.now(oracle);
      auto const after = oracle.template groups_of<Quad4>();
      std::vector<Index> forth, back;
      for (std::size_t e = 0; e < after.size(); ++e)
        if (after[e] != before[e]) (after[e] == 1 ? forth : back).push_back(static_cast<Index>(e));
      moves += static_cast<int>(forth.size() + back.size());
      if (!forth.empty()) body.template assign<Turning>(forth);
      if (!back.empty()) body.template assign<Linear>(back);

      REQUIRE(difference(body.displacements(), oracle.displacements()) < 1e-10);
    }
    CHECK(moves > 30);
    CHECK(largest(body.displacements()) > 0.3);
  });
}

}  // namespace pliant::test::switching_agreement_suite

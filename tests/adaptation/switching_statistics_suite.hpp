#pragma once

#include <numeric>

#include "support/seed_scene.hpp"

namespace pliant::test::switching_statistics_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

template <class B>
auto bending_body(B const& backend) {
  auto const mesh = seed_mesh<Quad4>();
  Body body{backend, mesh, seed_material, Group<Linear>{}, Group<Turning>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -10});
  return body;
}
inline auto bending_rules() {
  auto const criterion = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
  return Adaptation{when<Linear>(criterion).above(0.05).become<Turning>(),
                    when<Turning>(criterion).below(0.04).become<Linear>()};
}

TEST_CASE("the statistics follow every switch of a bending beam", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto body = bending_body(backend);
    auto const elements = body.mesh().template elements<Quad4>().size();
    auto adapt = bending_rules();
    CentralDifference step{{.step = 2e-4}};
    std::vector<Tag> groups(elements, 0);
    std::vector<int> switches(elements, 0);
    double steps[2]{}, moves[2]{}, energy = 0;
    double largest_energy = 0;
    // Down, and some way up again.
    for (int k = 0; k < 900; ++k) {
      step(body, 8);
      for (Tag g : groups) steps[g] += 8;
      double const before = strain_energy(body);

      adapt.now(body);

      energy += strain_energy(body) - before;
      largest_energy = std::max(largest_energy, before);
      auto const now = body.template groups_of<Quad4>();
      for (std::size_t e = 0; e < elements; ++e)
        if (now[e] != groups[e]) ++switches[e], ++moves[groups[e]];
      groups = now;
    }
    REQUIRE(moves[0] > 30);
    REQUIRE(moves[1] > 10);

    CHECK(element_steps<Quad4>(body) == std::vector<double>{steps[0], steps[1]});
    CHECK(steps[0] + steps[1] == static_cast<double>(elements) * 7200);
    CHECK(switch_counts<Quad4>(body) == switches);
    auto const entries = ledger(body);
    REQUIRE(entries.size() == 2);
    CHECK(entries[0].elements == moves[0]);
    CHECK(entries[1].elements == moves[1]);
    // Each difference of two energies rounds to ε of these.
    double const rounding =
        500 * double{std::numeric_limits<typename B::scalar>::epsilon()} * largest_energy;
    CHECK(std::abs(entries[0].strain_energy + entries[1].strain_energy - energy) < rounding);
    CHECK(adaptation_energy(body) == Approx(entries[0].strain_energy + entries[0].kinetic_energy +
                                            entries[1].strain_energy + entries[1].kinetic_energy)
                                         .epsilon(1e-12));
    CHECK(std::abs(entries[0].strain_energy) > 20 * rounding);
  });
}

TEST_CASE("the statistics stay right when a user moves elements too", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bending_body(backend);
    auto adapt = bending_rules();
    adapt.now(body);
    CentralDifference step{{.step = 2e-4}};
    step(body, 10);
    body.template assign<Turning>({0, 1, 2});

    step(body, 5);

    CHECK(element_steps<Quad4>(body) == std::vector<double>{40 * 10 + 37 * 5, 3 * 5});
  });
}

TEST_CASE("steps are counted beyond 32 bits, and counts of switches end at the largest",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    constexpr int most = std::numeric_limits<int>::max();
    constexpr std::int64_t later = 4 * std::int64_t{most};
    auto body = bending_body(backend);
    auto& table = body.parts().layout.template table<Quad4>();
    auto& statistics = std::get<0>(body.parts().state.elements).statistics;
    auto const n = static_cast<std::size_t>(table.count());
    REQUIRE(n > 3);
    statistics.start(backend, table.count(), 10);
    std::vector<std::int32_t> switches(n, 65535);
    switches[0] = most - 1;
    switches[1] = most;
    statistics.switches.upload(switches);
    auto const counts_are = [&](int first, int others) {
      std::vector<int> expected(n, others);
      expected[static_cast<std::size_t>(table.user_elements()[0])] = first;
      expected[static_cast<std::size_t>(table.user_elements()[1])] = most;
      CHECK(switch_counts<Quad4>(body) == expected);
    };
    for (int k = 0; k < 4; ++k) body.parts().state.steps += most;

    auto const go = when<Linear>(Rotation{}).above(-1);
    Adaptation{go.stay(later - 9).template become<Turning>()}.now(body);
    counts_are(most - 1, 65535);
    Adaptation{go.stay(later - 10).template become<Turning>()}.now(body);
    counts_are(most, 65536);

    auto const elements = static_cast<double>(n);
    CHECK(element_steps<Quad4>(body) ==
          std::vector<double>{elements * static_cast<double>(later - 10), 0});
    body.parts().state.steps += 7;
    Adaptation{when<Turning>(Rotation{}).above(-1).template become<Linear>()}.now(body);
    counts_are(most, 65537);
    CHECK(element_steps<Quad4>(body) ==
          std::vector<double>{elements * static_cast<double>(later - 10), elements * 7});

    statistics.enter(std::vector<Tag>(n, 0), std::vector<Tag>(n, 1), 2 * later);
    counts_are(most, 65538);
  });
}

TEST_CASE("the energy of a body that switches is what its ledger says", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // Central differences keep energy up to Δt²; what is lost at the switches would be of order Δt.
    auto const drift = [&](double dt) {
      auto body = bending_body(backend);
      auto adapt = bending_rules();
      CentralDifference step{{.step = dt}};
      double largest_error = 0;
      while (body.time() < 0.5) {
        step(body, static_cast<int>(std::lround(1.6e-3 / dt)));
        adapt.now(body);
        largest_error =
            std::max(largest_error, std::abs(total_energy(body) - adaptation_energy(body)));
      }
      CHECK(std::abs(adaptation_energy(body)) > 0.1);
      return largest_error;
    };

    double const coarse = drift(2e-4), fine = drift(1e-4);

    CHECK(coarse < 0.02);  // J, of a kinetic energy up to 100
    CHECK(fine < 0.4 * coarse);
  });
}

}  // namespace pliant::test::switching_statistics_suite

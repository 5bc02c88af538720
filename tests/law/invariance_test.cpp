#include "support/laws.hpp"

namespace pliant::test::invariance_test {

/// Calls check(F, R) for states F and rotations R.
template <int Dim, class Check>
void on_rotated_states(Check const& check) {
  auto const identity = Tensor<double, Dim>::identity();
  Random random(11);
  for (int state = 0; state < 20; ++state) {
    auto const f = identity + random_state<Dim>(random);
    auto const r = random_rotation<Dim>(random);
    REQUIRE(largest<Dim>(r * transpose(r) - identity) < 1e-14);
    check(f, r);
  }
}

TEST_CASE("a rotation of the body leaves the energy and turns the stress", "[law]") {
  on_each_law<Ask::energy_and_stress>([](auto law, auto dim) {
    if (!law.kind.objective) return;
    constexpr int n = dim();
    auto const identity = Tensor<double, n>::identity();
    on_rotated_states<n>([&](auto const& f, auto const& r) {
      auto const p = stress(law, f - identity);
      double const rounding = 1e-13 * (1 + largest<n>(p));
      CHECK(energy_density(law, r * f - identity) ==
            Approx(energy_density(law, f - identity)).epsilon(0).margin(rounding));
      CHECK(largest<n>(stress(law, r * f - identity) - r * p) < rounding);
    });
  });
}

TEST_CASE("a rotation of the material leaves the energy and turns the stress", "[law]") {
  on_each_law<Ask::energy_and_stress>([](auto law, auto dim) {
    if (!law.kind.objective || !law.kind.isotropic) return;
    constexpr int n = dim();
    auto const identity = Tensor<double, n>::identity();
    on_rotated_states<n>([&](auto const& f, auto const& r) {
      auto const p = stress(law, f - identity);
      double const rounding = 1e-13 * (1 + largest<n>(p));
      CHECK(energy_density(law, f * r - identity) ==
            Approx(energy_density(law, f - identity)).epsilon(0).margin(rounding));
      CHECK(largest<n>(stress(law, f * r - identity) - p * r) < rounding);
    });
  });
}

TEST_CASE("plane strain is the 3D law with F33 = 1", "[law]") {
  on_each_maker([](auto make, char const* name, Kind kind) {
    auto const flat = any_law<Ask::energy_and_stress, 2, double>(make(1.0), kind);
    auto const solid = any_law<Ask::energy_and_stress, 3, double>(make(1.0), kind);
    Random random(12);
    for (int state = 0; state < 20; ++state) {
      INFO(name << ", state " << state);
      auto const h = random_state<2>(random);
      auto const p = stress(flat, h);
      auto const p_in_space = stress(solid, in_space(h));
      CHECK(energy_density(flat, h) == Approx(energy_density(solid, in_space(h))).epsilon(1e-13));
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          CHECK(p(i, j) == Approx(p_in_space(i, j)).epsilon(1e-13).margin(1e-14));
    }
  });
}

}  // namespace pliant::test::invariance_test

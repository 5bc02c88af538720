#include "support/laws.hpp"

namespace pliant::test {

template <class L, class Dimension, class Check>
void on_objective_states(L law, Dimension, Check const& check) {
  if constexpr (!std::same_as<L, Hooke<double>>) {
    constexpr int n = Dimension::value;
    auto const identity = Tensor<double, n>::identity();
    Random random(11);
    for (int state = 0; state < 20; ++state) {
      auto const f = identity + random_state<n>(random);
      auto const r = random_rotation<n>(random);
      REQUIRE(largest<n>(r * transpose(r) - identity) < 1e-14);
      check(law, f, r, identity);
    }
  }
}

TEST_CASE("a rotation of the body leaves the energy and turns the stress", "[law]") {
  on_each_law([](auto law, auto dim) {
    on_objective_states(law, dim, [](auto l, auto const& f, auto const& r, auto const& identity) {
      constexpr int n = decltype(dim)::value;
      CHECK(energy_density(l, r * f - identity) ==
            Approx(energy_density(l, f - identity)).epsilon(0).margin(1e-13));
      CHECK(largest<n>(stress(l, r * f - identity) - r * stress(l, f - identity)) < 1e-13);
    });
  });
}

TEST_CASE("a rotation of the material leaves the energy and turns the stress", "[law]") {
  on_each_law([](auto law, auto dim) {
    on_objective_states(law, dim, [](auto l, auto const& f, auto const& r, auto const& identity) {
      constexpr int n = decltype(dim)::value;
      CHECK(energy_density(l, f * r - identity) ==
            Approx(energy_density(l, f - identity)).epsilon(0).margin(1e-13));
      CHECK(largest<n>(stress(l, f * r - identity) - stress(l, f - identity) * r) < 1e-13);
    });
  });
}

TEST_CASE("plane strain is the 3D law with F33 = 1", "[law]") {
  on_each_law([](auto law, auto) {
    Random random(12);
    for (int state = 0; state < 20; ++state) {
      auto const h = random_state<2>(random);
      auto const p = stress(law, h);
      auto const p_in_space = stress(law, in_space(h));
      CHECK(energy_density(law, h) == Approx(energy_density(law, in_space(h))).epsilon(1e-13));
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          CHECK(p(i, j) == Approx(p_in_space(i, j)).epsilon(0).margin(1e-14));
    }
  });
}

}  // namespace pliant::test

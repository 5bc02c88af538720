#include <pliant/openmp/pack.hpp>

#include "support/laws.hpp"

// Laws on packs of elements, as the kernels of the CPU call them.
namespace pliant::test {

/// Holds a law on a pack, each lane of which has another state, to the law on numbers.
template <int Dim, class L, class LawInLane>
void check_lanes(L const& law, LawInLane const& law_in_lane) {
  using P = Pack<double>;
  Random random(28);
  for (int round = 0; round < 5; ++round) {
    Tensor<double, Dim> h[P::lanes], dh[P::lanes];
    Tensor<P, Dim> hs, dhs;
    for (int lane = 0; lane < P::lanes; ++lane) {
      h[lane] = random_state<Dim>(random, lane == 0 ? 0.0 : 0.25);  // one lane is at rest
      dh[lane] = random.tensor<Dim>(1);
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          hs(i, j).v[lane] = h[lane](i, j);
          dhs(i, j).v[lane] = dh[lane](i, j);
        }
    }
    auto const w = energy_density(law, hs);
    auto const p = stress(law, hs), dp = stress_tangent_product(law, hs, dhs);
    for (int lane = 0; lane < P::lanes; ++lane) {
      INFO("lane " << lane);
      auto const expected = stress(law_in_lane(lane), h[lane]);
      auto const change = stress_tangent_product(law_in_lane(lane), h[lane], dh[lane]);
      CHECK(w[lane] == Approx(energy_density(law_in_lane(lane), h[lane])).epsilon(1e-12));
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          CHECK(std::abs(p(i, j)[lane] - expected(i, j)) < 1e-13 * (1 + largest<Dim>(expected)));
          CHECK(std::abs(dp(i, j)[lane] - change(i, j)) < 1e-12 * largest<Dim>(change));
        }
    }
  }
}

TEST_CASE("laws compute in each lane of a pack what they do for a number", "[openmp]") {
  on_each_maker([](auto make, char const* name, Kind) {
    auto const law = make(1.0);
    DYNAMIC_SECTION(name) {
      check_lanes<3>(law, [&](int) { return law; });
    }
  });
}

TEST_CASE("each element of a pack has its own values", "[openmp]") {
  using P = Pack<double>;
  Random random(29);
  Vector<double, 6> values[P::lanes];
  Vector<P, 6> packed;
  for (int lane = 0; lane < P::lanes; ++lane)
    for (int k = 0; k < 6; ++k) packed[k].v[lane] = values[lane][k] = lane == 1 ? 0 : random();
  HolzapfelGasserOgden<double> const wall{2, 1, 0.5, 0.1, 5};
  check_lanes<3>(wall.at(packed), [&](int lane) { return wall.at(values[lane]); });
}

}  // namespace pliant::test

#include <pliant/formulation/strong_ellipticity.hpp>

#include "support/laws.hpp"

namespace pliant::test::strong_ellipticity_test {

/// Calls visit(law, dimension) for each law itself, in 2D and 3D.
template <class Visit>
void on_each_own_law(Visit const& visit) {
  on_each_maker([&](auto make, char const* name, Kind) {
    INFO(name);
    visit(make(1.0), std::integral_constant<int, 2>{});
    visit(make(1.0), std::integral_constant<int, 3>{});
  });
}

TEST_CASE("acoustic tensors are changes of traction along planes that slide", "[formulation]") {
  on_each_own_law([](auto const& law, auto dim) {
    constexpr int n = dim();
    Random random(3);
    for (int state = 0; state < 5; ++state) {
      auto const h = random_state<n>(random);
      std::size_t visited = 0;
      detail::for_each_acoustic_tensor(law, h, [&](Tensor<double, n> const& q) {
        Vector<double, n> normal, slip;
        for (int k = 0; k < n; ++k) {
          normal[k] = detail::wave_directions<n>()[visited][static_cast<std::size_t>(k)];
          slip[k] = random();
        }
        auto const traction = stress_tangent_product(law, h, slip * transpose(normal)) * normal;
        CHECK(norm(q * slip - traction) < 1e-10 * (1 + norm(traction)));
        ++visited;
      });
      CHECK(visited == detail::wave_directions<n>().size());
    }
  });
}

TEST_CASE("laws are strongly elliptic where the least acoustic eigenvalue is positive",
          "[formulation]") {
  int held = 0, lost = 0;
  on_each_own_law([&](auto const& law, auto dim) {
    constexpr int n = dim();
    Random random(4);
    for (int state = 0; state < 200; ++state) {
      auto const h = random_state<n>(random, 0.6);
      double const least = least_acoustic_eigenvalue(law, h);
      if (std::abs(least) < 1e-9) continue;  // rounding decides
      CHECK(is_strongly_elliptic_at(law, h) == (0 < least));
      ++(0 < least ? held : lost);
    }
  });
  CHECK(held > 500);
  CHECK(lost > 200);
}

TEST_CASE("tensors are positive definite where all eigenvalues are positive", "[formulation]") {
  auto const check = []<int N>(std::integral_constant<int, N>) {
    Random random(5);
    std::array<int, N> negative{};  // how many tensors had so many, the last for more
    for (int k = 0; k < 300; ++k) {
      auto const axes = random_rotation<N>(random);
      auto values = Tensor<double, N>::zero();
      int below = 0;
      for (int i = 0; i < N; ++i) {
        values(i, i) = random() + 0.5;
        below += values(i, i) < 0 ? 1 : 0;
      }
      CHECK(detail::is_positive_definite(axes * values * transpose(axes)) == (below == 0));
      ++negative[static_cast<std::size_t>(std::min(below, N - 1))];
    }
    for (int count : negative) CHECK(count > 5);
  };
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
  auto unknown = Tensor<double, 3>::identity();
  unknown(2, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!detail::is_positive_definite(unknown));
  unknown = Tensor<double, 3>::identity();
  unknown(0, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!detail::is_positive_definite(unknown));
}

}  // namespace pliant::test::strong_ellipticity_test

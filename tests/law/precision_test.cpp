#include "support/laws.hpp"

namespace pliant::test::precision_test {

template <int Dim>
Tensor<double, Dim> in_double(Tensor<float, Dim> const& a) {
  Tensor<double, Dim> b;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) b(i, j) = static_cast<double>(a(i, j));
  return b;
}

/// Holds the law in single precision to itself in double precision, at the same states: what was
/// rounded into those is no error of the law.
template <int Dim, class Make>
void check_precision(Make const& make) {
  auto const single = any_law<Ask::energy_and_stress, Dim, float>(make(1.0f), {});
  auto const exact = any_law<Ask::energy_and_stress, Dim, double>(make(1.0), {});
  for (double strain : {1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.25, 1.0}) {
    Random random(13);
    for (int state = 0; state < 50; ++state) {
      auto const drawn = random_state<Dim>(random, strain);
      Tensor<float, Dim> h;
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) h(i, j) = static_cast<float>(drawn(i, j));
      INFO("strain " << strain << ", state " << state);
      auto const p = in_double(stress(single, h)), exact_p = stress(exact, in_double(h));
      double const w = double{energy_density(single, h)},
                   exact_w = energy_density(exact, in_double(h));
      // Far out conditions are worse, and there are limits that no state may come near.
      if (strain > 0.5 && !(largest<Dim>(exact_p) < 100)) continue;
      double const tolerance = strain > 0.5 ? 2e-5 : 2e-6;
      CHECK(largest<Dim>(p - exact_p) < tolerance * largest<Dim>(exact_p));
      CHECK(w == Approx(exact_w).epsilon(tolerance));
    }
  }
}

TEST_CASE("single precision keeps its digits at all strains", "[law]") {
  on_each_maker([](auto make, char const* name, Kind) {
    DYNAMIC_SECTION(name << " in 2D") { check_precision<2>(make); }
    DYNAMIC_SECTION(name << " in 3D") { check_precision<3>(make); }
  });
}

template <class T>
struct Fibres {
  T stiffness, direction[3];
  template <class S>
  PLIANT_HOST_DEVICE S energy(Tensor<S, 3> const& h) const {
    return stiffness * direction[0] * square(h(0, 0));
  }
};

TEST_CASE("law_cast changes the precision of every parameter", "[law]") {
  auto const single = law_cast<float>(NeoHookean<double>{1.1, 2.2});
  static_assert(std::same_as<decltype(single), NeoHookean<float> const>);
  CHECK(single.lambda == 1.1f);
  CHECK(single.mu == 2.2f);
  auto const back = law_cast<double>(single);
  CHECK(back.lambda == static_cast<double>(1.1f));
  auto const fibres = law_cast<float>(Fibres<double>{1, {2, 3, 4.5}});
  CHECK(fibres.direction[2] == 4.5f);
  CHECK(fibres.stiffness == 1);
}

TEST_CASE("law_cast refuses parameters that the precision cannot hold", "[law]") {
  for (double value : {1e39, 1e300, -1e300, 1e-60}) {
    CHECK_THROWS_WITH(
        law_cast<float>(NeoHookean<double>{3, value}),
        says("law_cast: parameter 1 of a law is ") && says("which 32 bits cannot hold"));
    CHECK(law_cast<double>(NeoHookean<double>{3, value}).mu == value);
  }
  CHECK_THROWS_WITH(law_cast<double>(NeoHookean<double>{INFINITY, 2}), says("parameter 0"));
  CHECK(law_cast<float>(NeoHookean<double>{0, 3e38}).mu == 3e38f);
}

}  // namespace pliant::test::precision_test

#include "support/difference_quotient.hpp"
#include "support/laws.hpp"

// Laws of the principal stretches where those are equal, or change sign.
namespace pliant::test::stretches_test {

/// R Q diag(l) Qᵀ − I with rotations Q and R.
template <int Dim>
Tensor<double, Dim> stretched(std::array<double, 3> const& l, Random& random) {
  auto const q = random_rotation<Dim>(random), r = random_rotation<Dim>(random);
  return r * (q * diagonal<Dim>(l) * transpose(q)) - Tensor<double, Dim>::identity();
}

template <int Dim, class L>
void check_derivatives(L const& law, Tensor<double, Dim> const& h, Random& random,
                       double step = 2e-3) {
  auto const along = random.tensor<Dim>(1);
  auto const p = stress(law, h), dp = stress_tangent_product(law, h, along);
  auto const power = derivative([&](double t) { return energy_density(law, h + t * along); }, step);
  auto const slope =
      tensor_derivative<Dim>([&](double t) { return stress(law, h + t * along); }, step);
  CHECK(dot(p, along) == Approx(power).epsilon(0).margin(1e-8 * (1 + largest<Dim>(p))));
  CHECK(largest<Dim>(dp - slope) < 1e-8 * largest<Dim>(dp));
}

/// The corotated law as a user may write it.
template <class T>
struct OfStretches {
  T lambda, mu;
  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalStretches<S> const& l) const {
    return mu * (square(l[0]) + square(l[1]) + square(l[2])) +
           lambda / 2 * square(l[0] + l[1] + l[2]);
  }
};
static_assert(EnergyIn<OfStretches<double>, PrincipalStretches>);

template <class Check>
void on_laws_of_stretches(Check const& check) {
  SECTION("Ogden") { check(law_of_section_6<Ogden>); }
  SECTION("Corotated") { check(law_of_section_6<Corotated>); }
  SECTION("in stretches") { check(OfStretches<double>{3, 2}); }
}

TEST_CASE("stresses and tangents are exact where stretches are equal, or nearly", "[law]") {
  on_laws_of_stretches([](auto const& law) {
    Random random(21);
    // About the gap of 6e-6 below which a limit stands for the divided difference.
    for (double gap : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 5e-6, 7e-6, 1e-5, 1e-4, 1e-3})
      for (double middle : {0.7, 1.0, 1.6})
        for (int state = 0; state < 5; ++state) {
          INFO("gap " << gap << " at " << middle);
          std::array const pair{middle, middle + gap, 1.2}, all{middle, middle + gap, middle - gap};
          check_derivatives<2>(law, stretched<2>(pair, random), random);
          check_derivatives<3>(law, stretched<3>(pair, random), random);
          check_derivatives<3>(law, stretched<3>(all, random), random);
        }
  });
}

TEST_CASE("single precision keeps tangents where stretches are nearly equal", "[law]") {
  Random random(22);
  for (double gap : {0.0, 1e-6, 1e-4, 1e-3, 4e-3, 6e-3, 1e-2, 0.1})
    for (int state = 0; state < 20; ++state) {
      INFO("gap " << gap);
      auto const drawn = stretched<3>({1.1, 1.1 + gap, 1.1 - 2 * gap}, random);
      auto const direction = random.tensor<3>(1);
      Tensor<float, 3> h, dh;
      Tensor<double, 3> same, same_dh;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          same(i, j) = h(i, j) = static_cast<float>(drawn(i, j));
          same_dh(i, j) = dh(i, j) = static_cast<float>(direction(i, j));
        }
      auto const dp = stress_tangent_product(law_of_section_6<Ogden, float>, h, dh);
      auto const exact = stress_tangent_product(law_of_section_6<Ogden>, same, same_dh);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          CHECK(std::abs(double{dp(i, j)} - exact(i, j)) < 2e-5 * largest<3>(exact));
    }
}

TEST_CASE("the corotated law turns inverted states about, not inside out", "[law]") {
  // The smallest stretch is negative: W = μ Σ (λₖ − 1)² + λ/2 (Σ λₖ − 3)².
  auto const law = law_of_section_6<Corotated>;
  OfStretches<double> const in_stretches{3, 2};
  Random random(23);
  for (std::array<double, 3> const& l :
       {std::array{1.2, 0.9, -0.3}, {1.2, 0.9, 1e-9}, {1.2, 0.9, 0.0}, {1.2, 0.9, -0.7}}) {
    INFO("smallest stretch " << l[2]);
    double const sum = l[0] + l[1] + l[2] - 3;
    double const w = 2 * (square(l[0] - 1) + square(l[1] - 1) + square(l[2] - 1)) + 1.5 * sum * sum;
    for (int state = 0; state < 10; ++state) {
      auto const h = stretched<3>(l, random);
      CHECK(energy_density(law, h) == Approx(w).epsilon(1e-12));
      check_derivatives<3>(law, h, random, 5e-4);
      CHECK(energy_density(in_stretches, h) == Approx(w).epsilon(1e-12));
      check_derivatives<3>(in_stretches, h, random, 5e-4);
      CHECK(largest<3>(stress(law, h) - stress(in_stretches, h)) < 1e-11);
    }
  }
}

TEST_CASE("the corotated law bears mirrored states, whose rotation is anyone's", "[law]") {
  auto const law = law_of_section_6<Corotated>;
  auto const mirror = diagonal<3>({-2, 0, 0}), turned_out = diagonal<3>({-2, -2, -2});
  for (auto const& h : {mirror, turned_out, diagonal<3>({-1.999, 0, 0})}) {
    double const sum = h(0, 0) == -1.999 ? -1.999 : -2;  // one stretch of −1, or nearly
    CHECK(energy_density(law, h) == Approx(2 * sum * sum + 1.5 * sum * sum).epsilon(0.01));
    CHECK(largest<3>(stress(law, h)) < 50);
    CHECK(largest<3>(stress(OfStretches<double>{3, 2}, h)) < 50);
  }
}

TEST_CASE("the corotated law is mu |F - R|^2 + lambda/2 tr(R'F - I)^2", "[law]") {
  // With F = R U: P = 2μ (F − R) + λ tr(U − I) R.
  auto const law = law_of_section_6<Corotated>;
  auto const check = [&]<int Dim>(std::integral_constant<int, Dim>) {
    auto const identity = Tensor<double, Dim>::identity();
    Random random(24);
    for (int state = 0; state < 30; ++state) {
      std::array<double, 3> const l{1 + 0.6 * random(), 1 + 0.6 * random(), 1 + 0.6 * random()};
      auto const q = random_rotation<Dim>(random), r = random_rotation<Dim>(random);
      auto const u = q * diagonal<Dim>(l) * transpose(q);
      auto const expected = 4.0 * (r * u - r) + 3 * trace(u - identity) * r;
      CHECK(largest<Dim>(stress(law, r * u - identity) - expected) < 1e-13);
    }
  };
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
}

}  // namespace pliant::test::stretches_test

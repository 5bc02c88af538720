#include <pliant/law/law.hpp>

#include "support/laws.hpp"

// The energies as they are printed, of F and not of H, with nothing shifted: what the laws must be.
namespace pliant::test::printed_energies_test {

/// The invariants of a state in their textbook form.
struct Printed {
  double I1, I2, J, I1_bar, I2_bar;
  Tensor<double, 3> E;

  explicit Printed(Tensor<double, 3> const& h) {
    auto const f = Tensor<double, 3>::identity() + h;
    auto const c = transpose(f) * f;
    I1 = trace(c);
    I2 = (I1 * I1 - dot(c, c)) / 2;
    J = determinant(f);
    I1_bar = std::pow(J, -2.0 / 3) * I1;
    I2_bar = std::pow(J, -4.0 / 3) * I2;
    E = 0.5 * (c - Tensor<double, 3>::identity());
  }
};

template <class L, class Energy>
void check_printed(L const& law, Energy const& energy) {
  Random random(14);
  for (int state = 0; state < 30; ++state) {
    auto const h = random_state<3>(random), flat = in_space(random_state<2>(random));
    CHECK(energy_density(law, h) == Approx(energy(Printed(h))).epsilon(1e-12).margin(1e-13));
    CHECK(energy_density(law, flat) == Approx(energy(Printed(flat))).epsilon(1e-12).margin(1e-13));
  }
}

double bulk_energy(double bulk, double J) { return bulk / 2 * square(J - 1); }

TEST_CASE("energies in the invariants of C are the printed ones", "[law]") {
  double const lambda = 3, mu = 2;
  check_printed(NeoHookean<double>{lambda, mu}, [&](Printed const& s) {
    double const log_J = std::log(s.J);
    return mu / 2 * (s.I1 - 3) - mu * log_J + lambda / 2 * log_J * log_J;
  });
  check_printed(StableNeoHookean<double>{lambda, mu}, [&](Printed const& s) {
    return mu / 2 * (s.I1 - 3) - mu * (s.J - 1) + (lambda + mu) / 2 * square(s.J - 1);
  });
  check_printed(Fung<double>{lambda, mu, 1.5}, [&](Printed const& s) {
    double const Q = 1.5 * (2 * dot(s.E, s.E) + lambda / mu * square(trace(s.E)));
    return mu / 3 * (std::exp(Q) - 1);
  });
}

TEST_CASE("energies in the isochoric invariants are the printed ones", "[law]") {
  double const bulk = 5;
  check_printed(IsochoricNeoHookean<double>{2, bulk}, [&](Printed const& s) {
    return 2.0 / 2 * (s.I1_bar - 3) + bulk_energy(bulk, s.J);
  });
  check_printed(SimoNeoHookean<double>{2, bulk}, [&](Printed const& s) {
    return 2.0 / 2 * (s.I1_bar - 3) + bulk / 4 * (s.J * s.J - 1 - 2 * std::log(s.J));
  });
  check_printed(MooneyRivlin<double>{0.75, 0.25, bulk}, [&](Printed const& s) {
    return 0.75 * (s.I1_bar - 3) + 0.25 * (s.I2_bar - 3) + bulk_energy(bulk, s.J);
  });
  check_printed(Yeoh<double>{1, -0.1, 0.02, bulk}, [&](Printed const& s) {
    double const i = s.I1_bar - 3;
    return i - 0.1 * i * i + 0.02 * i * i * i + bulk_energy(bulk, s.J);
  });
  check_printed(Gent<double>{2, 12, bulk}, [&](Printed const& s) {
    return -2.0 * 12 / 2 * std::log(1 - (s.I1_bar - 3) / 12) + bulk_energy(bulk, s.J);
  });
  check_printed(ArrudaBoyce<double>{2, 1.3, bulk}, [&](Printed const& s) {
    double const a[] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
    double w = bulk_energy(bulk, s.J);
    for (int k = 1; k <= 5; ++k)
      w += 2 * a[k - 1] / std::pow(1.3, 2 * k - 2) * (std::pow(s.I1_bar, k) - std::pow(3.0, k));
    return w;
  });
}

/// An invariant set that no law here writes its energy in alone.
template <class T>
struct CompressibleMooney {
  T c1, c2;
  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalInvariants<S> const& i) const {
    return c1 * i.I1_minus_3() + c2 * i.I2_minus_3() - (2 * c1 + 4 * c2) * log1p(i.J_minus_1);
  }
};
static_assert(EnergyIn<CompressibleMooney<double>, PrincipalInvariants>);

TEST_CASE("an energy in I1, I2 and J is the printed one", "[law]") {
  check_printed(CompressibleMooney<double>{0.75, 0.25}, [](Printed const& s) {
    return 0.75 * (s.I1 - 3) + 0.25 * (s.I2 - 3) - 2.5 * std::log(s.J);
  });
}

TEST_CASE("energies of fibres are the printed ones", "[law]") {
  // An orthonormal frame: the fibre and two directions across.
  Vector<double, 3> const f{{{0.6}, {0.8}, {0}}}, s{{{-0.48}, {0.36}, {0.8}}},
      n{{{0.64}, {-0.48}, {0.6}}};
  check_printed(Guccione<double>{2, 8, 2, 4, 5}.at(7 * f), [&](Printed const& state) {
    auto const E = [&](auto const& a, auto const& b) { return dot(a, state.E * b); };
    double const Q = 8 * square(E(f, f)) +
                     2 * (square(E(s, s)) + square(E(n, n)) + 2 * square(E(s, n))) +
                     8 * (square(E(f, s)) + square(E(f, n)));
    return std::exp(Q) - 1 + bulk_energy(5, state.J);
  });
  Vector<double, 6> const families{{{0.6}, {0.8}, {0}, {0.64}, {-0.48}, {0.6}}};
  double const k1 = 3, k2 = 0.7;
  for (double dispersion : {0.0, 0.1, 1.0 / 3})
    check_printed(HolzapfelGasserOgden<double>{2, k1, k2, dispersion, 5}.at(families),
                  [&](Printed const& state) {
                    double w = state.I1_bar - 3 + bulk_energy(5, state.J);
                    for (auto const& a : {f, n}) {
                      double const I4 = 1 + 2 * dot(a, state.E * a);
                      double const strain =
                          dispersion * (state.I1 - 3) + (1 - 3 * dispersion) * (I4 - 1);
                      if (strain > 0) w += k1 / (2 * k2) * (std::exp(k2 * strain * strain) - 1);
                    }
                    return w;
                  });
}

/// F = Q diag(l) Qᵀ, turned.
Tensor<double, 3> stretched(std::array<double, 3> const& l, Random& random) {
  auto const q = random_rotation<3>(random), r = random_rotation<3>(random);
  return r * (q * diagonal<3>(l) * transpose(q)) - Tensor<double, 3>::identity();
}

TEST_CASE("energies in the stretches are the printed ones", "[law]") {
  Random random(15);
  for (int state = 0; state < 30; ++state) {
    std::array<double, 3> const l{1 + 0.6 * random(), 1 + 0.6 * random(), 1 + 0.6 * random()};
    auto const h = stretched(l, random);
    double const J = l[0] * l[1] * l[2], sum = l[0] + l[1] + l[2] - 3;
    double squares = 0, ogden = bulk_energy(5, J);
    double const mu[] = {1.5, 0.1, -0.4}, alpha[] = {1.3, 5, -2};
    for (double x : l) {
      squares += square(x - 1);
      for (int p = 0; p < 3; ++p)
        ogden += mu[p] / alpha[p] * (std::pow(x / std::cbrt(J), alpha[p]) - 1);
    }
    CHECK(energy_density(Corotated<double>{3, 2}, h) ==
          Approx(2 * squares + 1.5 * sum * sum).epsilon(1e-12));
    CHECK(energy_density(Ogden<double>{{1.5, 0.1, -0.4}, {1.3, 5, -2}, 5}, h) ==
          Approx(ogden).epsilon(1e-12));
  }
}

TEST_CASE("Ogden's law of two terms is Mooney and Rivlin's", "[law]") {
  // λ̄² and λ̄⁻² sum to Ī₁ and Ī₂.
  Ogden<double> const ogden{{1.5, -0.5, 0}, {2, -2, 1}, 5};
  MooneyRivlin<double> const mooney{0.75, 0.25, 5};
  Random random(16);
  for (int state = 0; state < 30; ++state) {
    auto const h = random_state<3>(random), along = random.tensor<3>(1);
    CHECK(energy_density(ogden, h) == Approx(energy_density(mooney, h)).epsilon(1e-12));
    CHECK(largest<3>(stress(ogden, h) - stress(mooney, h)) < 1e-12);
    CHECK(largest<3>(stress_tangent_product(ogden, h, along) -
                     stress_tangent_product(mooney, h, along)) < 1e-10);
  }
}

}  // namespace pliant::test::printed_energies_test

#include <pliant/law/decorators/per_element.hpp>

#include "support/laws.hpp"

// Laws some of whose parameters are values of an element.
namespace pliant::test::fibres_test {

static_assert(LawPerElement<Guccione<double>> && Law<Guccione<float>> &&
              !PointLaw<Guccione<double>>);
static_assert(LawPerElement<HolzapfelGasserOgden<double>>);
static_assert(LawPerElement<PerElement<NeoHookean>::law<double>>);
static_assert(LawFromElastic<PerElement<NeoHookean>::law<double>>);
static_assert(!LawPerElement<NeoHookean<double>> && PointLaw<NeoHookean<double>>);
static_assert(PointLaw<Guccione<double>::Along<float>>);

using Direction = Vector<double, 3>;

/// The directions of two families.
Vector<double, 6> both(Direction const& a, Direction const& b) {
  return {{{a[0]}, {a[1]}, {a[2]}, {b[0]}, {b[1]}, {b[2]}}};
}

TEST_CASE("the length and the sense of a fibre do not matter", "[law]") {
  Guccione<double> const muscle{2, 8, 2, 4, 5};
  HolzapfelGasserOgden<double> const wall{2, 1, 0.5, 0.1, 5};
  Random random(25);
  for (int state = 0; state < 20; ++state) {
    auto const h = random_state<3>(random);
    Direction const a{{{random()}, {random()}, {random()}}},
        b{{{random()}, {random()}, {random()}}};
    CHECK(largest<3>(stress(muscle.at(a), h) - stress(muscle.at(-30.0 * a), h)) < 1e-11);
    CHECK(largest<3>(stress(wall.at(both(a, b)), h) -
                     stress(wall.at(both(-2.0 * a, 1e-3 * b)), h)) < 1e-11);
    CHECK(largest<3>(stress(wall.at(both(a, b)), h) - stress(wall.at(both(b, a)), h)) < 1e-11);
  }
}

TEST_CASE("fibres turn with the material", "[law]") {
  Guccione<double> const muscle{2, 8, 2, 4, 5};
  HolzapfelGasserOgden<double> const wall{2, 1, 0.5, 0.1, 5};
  auto const identity = Tensor<double, 3>::identity();
  Random random(26);
  for (int state = 0; state < 20; ++state) {
    auto const f = identity + random_state<3>(random);
    auto const r = random_rotation<3>(random);
    Direction const a{{{random()}, {random()}, {random()}}},
        b{{{random()}, {random()}, {random()}}};
    auto const check = [&](auto const& law, auto const& turned) {
      auto const p = stress(law, f - identity);
      CHECK(largest<3>(stress(turned, f * transpose(r) - identity) - p * transpose(r)) <
            1e-12 * (1 + largest<3>(p)));
    };
    check(muscle.at(a), muscle.at(r * a));
    check(wall.at(both(a, b)), wall.at(both(r * a, r * b)));
  }
}

TEST_CASE("Guccione's law with equal exponents is isotropic, and Hooke's at small strain",
          "[law]") {
  // c b = 2μ, and κ stands for λ.
  Guccione<double> const muscle{2, 2, 2, 2, 3};
  Random random(27);
  for (int state = 0; state < 20; ++state) {
    auto const h = random_state<3>(random), small = random.tensor<3>(1e-7);
    Direction const a{{{random()}, {random()}, {random()}}}, none = Direction::zero();
    CHECK(largest<3>(stress(muscle.at(a), h) - stress(muscle.at(none), h)) < 1e-12);
    CHECK(largest<3>(stress(muscle.at(a), small) - stress(law_of_section_6<Hooke>, small)) < 1e-12);
  }
}

TEST_CASE("shortened fibres carry nothing", "[law]") {
  HolzapfelGasserOgden<double> const wall{2, 7, 0.5, 0, 5};
  auto const fibrous = wall.at(both({{{1}, {0}, {0}}}, {{{0}, {1}, {0}}}));
  auto const plain = wall.at(Vector<double, 6>::zero());
  IsochoricNeoHookean<double> const matrix{2, 5};
  auto const shortened = diagonal<3>({-0.2, -0.1, 0.3}), stretched = diagonal<3>({0.2, -0.1, 0});
  CHECK(largest<3>(stress(fibrous, shortened) - stress(matrix, shortened)) < 1e-14);
  CHECK(largest<3>(stress(plain, stretched) - stress(matrix, stretched)) < 1e-14);
  // One family: 2 k₁ ε exp(k₂ ε²) F a ⊗ a with ε = 0.44.
  auto const p = stress(fibrous, stretched) - stress(matrix, stretched);
  CHECK(p(0, 0) == Approx(2 * 7 * 0.44 * std::exp(0.5 * 0.44 * 0.44) * 1.2));
  CHECK(std::abs(p(1, 1)) + std::abs(p(2, 2)) + std::abs(p(0, 1)) < 1e-14);
}

TEST_CASE("fully dispersed fibres have no direction", "[law]") {
  HolzapfelGasserOgden<double> const wall{2, 7, 0.5, 1.0 / 3, 5};
  Direction const x{{{1}, {0}, {0}}}, y{{{0}, {1}, {0}}}, z{{{0}, {0}, {1}}};
  auto const h = diagonal<3>({0.3, -0.1, 0.05});
  CHECK(largest<3>(stress(wall.at(both(x, y)), h) - stress(wall.at(both(z, z)), h)) < 1e-13);
}

TEST_CASE("a law per element is the law with the parameters of the element", "[law]") {
  auto const h = diagonal<3>({0.2, -0.1, 0.05});
  PerElement<NeoHookean>::law<double> const graded{};
  static_assert(graded.element_values == 2);
  static_assert(PerElement<Ogden>::law<float>::element_values == 7);
  auto const law = graded.at(Vector<double, 2>{{{3}, {2}}});
  static_assert(std::same_as<decltype(law), NeoHookean<double> const>);
  CHECK(energy_density(law, h) == energy_density(NeoHookean<double>{3, 2}, h));
  Vector<double, 7> const values{{{1}, {2}, {3}, {1.5}, {4}, {-2}, {9}}};
  auto const ogden = PerElement<Ogden>::law<double>{}.at(values);
  CHECK(energy_density(ogden, h) == energy_density(Ogden<double>{{1, 2, 3}, {1.5, 4, -2}, 9}, h));
}

TEST_CASE("a law whose values are all per element has no parameters", "[law]") {
  PerElement<NeoHookean>::law<double> const graded{};
  CHECK(parameters(graded).size() == 0);
  auto const single = law_cast<float>(graded);
  static_assert(std::same_as<decltype(single), PerElement<NeoHookean>::law<float> const>);
  CHECK(parameters(Guccione<double>{2, 8, 2, 4, 5}).size() == 5);
  CHECK(law_cast<float>(HolzapfelGasserOgden<double>{2, 1, 0.5, 0.1, 5}).k2 == 0.5f);
}

/// Guccione's law of muscle, its fibres along the first axis, in the components of the strain.
template <class T>
struct AlignedMuscle {
  T c, fibre, transverse, shearing, bulk;

  template <class S, int Dim>
  PLIANT_HOST_DEVICE S energy(GreenStrain<S, Dim> const& E) const {
    S across = square(E(1, 1)), shear = square(E(0, 1));
    if constexpr (Dim == 3) {
      across = across + square(E(2, 2)) + 2 * square(E(1, 2));
      shear = shear + square(E(0, 2));
    }
    return c / 2 * expm1(fibre * square(E(0, 0)) + transverse * across + 2 * shearing * shear);
  }
  template <class S>
  PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const {
    return bulk / 2 * square(i.J_minus_1);
  }
};

TEST_CASE("an energy in components of the strain is that in invariants of the fibre", "[law]") {
  AlignedMuscle<double> const aligned{2, 4, 1, 3, 5};
  auto const fibrous = Guccione<double>{2, 4, 1, 3, 5}.at(Direction{{{1}, {0}, {0}}});
  auto const check = [&]<int Dim>(std::integral_constant<int, Dim>) {
    Random random(26);
    for (int state = 0; state < 20; ++state) {
      auto const h = random_state<Dim>(random), dh = random.tensor<Dim>(1);
      CHECK(energy_density(aligned, h) == Approx(energy_density(fibrous, h)).epsilon(1e-12));
      CHECK(largest<Dim>(stress(aligned, h) - stress(fibrous, h)) < 1e-12);
      CHECK(largest<Dim>(stress_tangent_product(aligned, h, dh) -
                         stress_tangent_product(fibrous, h, dh)) < 1e-11);
    }
  };
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
}

}  // namespace pliant::test::fibres_test

#include <functional>

#include <pliant/body/body.hpp>
#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/plane_stress.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/mesh/rectangle.hpp>
#include <pliant/reference.hpp>

#include "support/laws.hpp"

// What laws find impossible among their parameters.
namespace pliant::test::ranges_test {

/// A law whose parameters are possible, and its check with one of them replaced.
struct Checked {
  template <template <class> class L>
  Checked(L<double> const& law)
      : count(parameters(law).size()), check_with([law](std::size_t k, double value) {
          auto list = parameters(law);
          if (k < list.size()) list[k] = value;
          std::bit_cast<L<double>>(list).check();
        }) {}
  std::size_t count;
  std::function<void(std::size_t, double)> check_with;
};

/// Holds the law to refuse each of some values of its parameter k, with a message that has all of `says`,
/// and to take others.
void check_range(Checked const& law, std::size_t k, std::vector<double> const& refused,
                 std::vector<double> const& taken, std::string const& what,
                 std::string const& range) {
  INFO(what << ", parameter " << k);
  REQUIRE(k < law.count);
  CHECK_NOTHROW(law.check_with(law.count, 0));
  for (double value : refused) {
    INFO(value);
    CHECK_THROWS_WITH(law.check_with(k, value), says(what + " is ") && says("; it must " + range));
  }
  CHECK_THROWS_AS(law.check_with(k, NAN), Error);
  for (double value : taken) {
    INFO(value);
    CHECK_NOTHROW(law.check_with(k, value));
  }
}
std::vector<double> const not_positive{0, -1e-9, -100};

TEST_CASE("laws of Lame's parameters resist shear and change of volume", "[law]") {
  auto const check = [](Checked const& law, std::string const& name) {
    check_range(law, 1, not_positive, {1e-9, 50}, name + "'s mu", "be positive (in Pa)");
    check_range(law, 0, {-4.0 / 3, -2, -1e9}, {-1.33, 0, 1e9}, name + "'s lambda",
                "be above -2/3 mu, here -1.33333 (in Pa)");
  };
  check(Hooke<double>{3, 2}, "Hooke");
  check(SaintVenantKirchhoff<double>{3, 2}, "Saint Venant-Kirchhoff");
  check(NeoHookean<double>{3, 2}, "the neo-Hookean law");
  check(StableNeoHookean<double>{3, 2}, "the stable neo-Hookean law");
  check(Corotated<double>{3, 2}, "the corotated law");
  check(Fung<double>{3, 2, 1}, "Fung");
  check_range(Fung<double>{3, 2, 1}, 2, not_positive, {0.1}, "Fung's exponent", "be positive");
}

TEST_CASE("laws of rubber resist shear and change of volume", "[law]") {
  std::string const pa = "be positive (in Pa)";
  IsochoricNeoHookean<double> const isochoric{2, 5};
  check_range(isochoric, 0, not_positive, {1}, "the isochoric neo-Hookean law's mu", pa);
  check_range(isochoric, 1, not_positive, {1}, "the isochoric neo-Hookean law's bulk modulus", pa);
  SimoNeoHookean<double> const simo{2, 5};
  check_range(simo, 0, not_positive, {1}, "Simo's neo-Hookean mu", pa);
  check_range(simo, 1, not_positive, {1}, "Simo's neo-Hookean bulk modulus", pa);
  MooneyRivlin<double> const mooney{0.75, 0.25, 5};
  check_range(mooney, 0, {-0.25, -1}, {-0.24, 0}, "Mooney-Rivlin's c1 + c2", pa);
  check_range(mooney, 1, {-0.75, -1}, {-0.74, 0}, "Mooney-Rivlin's c1 + c2", pa);
  check_range(mooney, 2, not_positive, {1}, "Mooney-Rivlin's bulk modulus", pa);
  Yeoh<double> const yeoh{1, -0.2, 0.1, 5};
  check_range(yeoh, 0, not_positive, {1}, "Yeoh's c1", pa);
  check_range(yeoh, 3, not_positive, {1}, "Yeoh's bulk modulus", pa);
  Gent<double> const gent{2, 10, 5};
  check_range(gent, 0, not_positive, {1}, "Gent's mu", pa);
  check_range(gent, 1, not_positive, {1}, "Gent's limit", "be positive");
  check_range(gent, 2, not_positive, {1}, "Gent's bulk modulus", pa);
  ArrudaBoyce<double> const chains{2, 7, 5};
  check_range(chains, 0, not_positive, {1}, "Arruda-Boyce's mu", pa);
  check_range(chains, 1, {1, 0.5, -7}, {1.01}, "Arruda-Boyce's locking stretch", "be above 1");
  check_range(chains, 2, not_positive, {1}, "Arruda-Boyce's bulk modulus", pa);
  Ogden<double> const ogden{{1.5, 0.2, -0.4}, {1.3, 5, -2}, 5};  // 2μ = 1.95 + 1 + 0.8
  std::string const shear = "Ogden's shear modulus, half the sum of mu alpha,";
  check_range(ogden, 0, {-1.8 / 1.3 - 0.01, -2}, {-1.38, 0}, shear, pa);
  check_range(ogden, 4, {-13.76, -15}, {-13.74}, shear, pa);
  for (std::size_t k : {3U, 4U, 5U})
    check_range(ogden, k, {0}, {1e-3}, "an alpha of Ogden", "not be 0, even where its mu is");
  check_range(ogden, 6, not_positive, {1}, "Ogden's bulk modulus", pa);
}

TEST_CASE("laws of fibres have positive constants and a dispersion up to 1/3", "[law]") {
  std::string const pa = "be positive (in Pa)";
  Guccione<double> const muscle{2, 8, 2, 4, 0};
  check_range(muscle, 0, not_positive, {1}, "Guccione's c", pa);
  check_range(muscle, 1, not_positive, {1}, "Guccione's exponent along fibres", "be positive");
  check_range(muscle, 2, not_positive, {1}, "Guccione's exponent across fibres", "be positive");
  check_range(muscle, 3, not_positive, {1}, "Guccione's exponent of shear", "be positive");
  check_range(muscle, 4, {-1}, {0, 1}, "Guccione's bulk modulus", "not be negative (in Pa)");
  HolzapfelGasserOgden<double> const wall{2, 1, 0.5, 0.1, 5};
  std::string const name = "Holzapfel-Gasser-Ogden's ";
  check_range(wall, 0, not_positive, {1}, name + "mu", pa);
  check_range(wall, 1, {-1e-9, -1}, {0, 1}, name + "k1", "not be negative (in Pa)");
  check_range(wall, 2, not_positive, {1}, name + "k2", "be positive");
  check_range(wall, 3, {-1e-9, 0.334, 5}, {0, 0.2, 1.0 / 3}, name + "dispersion", "be in [0, 1/3]");
  check_range(wall, 4, not_positive, {1}, name + "bulk modulus", pa);
  CHECK_NOTHROW(HolzapfelGasserOgden<float>{2, 1, 0.5f, 1.0f / 3, 5}.check());
}

/// The check of a law that stands for itself: a decorator's name says nothing of its template.
template <class L>
void check_message(L const& law, std::string const& message) {
  CHECK_THROWS_WITH(law.check(), says(message));
}

TEST_CASE("decorators refuse what they and their laws find impossible", "[law]") {
  using Voigt = KelvinVoigt<NeoHookean>::law<double>;
  CHECK_NOTHROW(Voigt{{3, 2}, 0}.check());
  check_message(Voigt{{3, 2}, -100}, "Kelvin-Voigt's viscosity is -100; it must not be negative");
  check_message(Voigt{{3, -2}, 1}, "the neo-Hookean law's mu is -2");
  using Maxwell = Prony<NeoHookean, 2>::law<double>;
  CHECK_NOTHROW(Maxwell{{3, 2}, {0, 1}, {1, 2}}.check());
  check_message(Maxwell{{3, 2}, {1, -3}, {1, 2}}, "a share of Prony is -3; it must not be");
  check_message(Maxwell{{3, 2}, {1, 1}, {0, 2}}, "a relaxation time of Prony is 0; it must be");
  check_message(Maxwell{{3, 0}, {1, 1}, {1, 2}}, "the neo-Hookean law's mu is 0");
  check_message(PlaneStress<Hooke>::law<double>{{{3, -2}}}, "Hooke's mu is -2");
  check_message(PlaneStress<Gent>::law<double>{{{2, 10, 0}}}, "Gent's bulk modulus is 0");
  Vector<double, 2> const row{{{3}, {-2}}};
  check_message(PerElement<Hooke>::law<double>{}.at(row), "Hooke's mu is -2");
}

TEST_CASE("laws with their parameters from an Elastic pass their own checks", "[law]") {
  for (double poisson : {-0.99, -0.5, 0.0, 0.3, 0.499999}) {
    Elastic const material{2e6, poisson, 1000};
    INFO(poisson);
    auto const check = [&]<template <class> class L>(L<double> const&) {
      CHECK_NOTHROW(L<double>::from(material).check());
    };
    check(Hooke<double>{});
    check(SaintVenantKirchhoff<double>{});
    check(NeoHookean<double>{});
    check(StableNeoHookean<double>{});
    check(IsochoricNeoHookean<double>{});
    check(SimoNeoHookean<double>{});
    check(Corotated<double>{});
    check(MooneyRivlin<double>{});
    check(Yeoh<double>{});
    check(Ogden<double>{});
    check(Gent<double>{});
    check(ArrudaBoyce<double>{});
    check(Fung<double>{});
  }
}

TEST_CASE("a body in single precision refuses moduli that only double holds", "[law]") {
  using F = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const mesh = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {1, 1}});
  Elastic const material{5.2, 0.3, 1};
  CHECK_THROWS_WITH((Body{Reference<float>{}, mesh, material, Group<F>{Hooke<double>{3, 1e39}}}),
                    says("parameter 1 of a law is 1e+39, which 32 bits cannot hold"));
  CHECK_THROWS_WITH((Body{Reference<float>{}, mesh, {1e300, 0.3, 1}, Group<F>{}}),
                    says("which 32 bits cannot hold"));
  CHECK_NOTHROW(Body{Reference<double>{}, mesh, {1e300, 0.3, 1}, Group<F>{}});
}

}  // namespace pliant::test::ranges_test

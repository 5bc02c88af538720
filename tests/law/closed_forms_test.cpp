#include "support/laws.hpp"

// Homogeneous states with λ = 3, μ = 2 (REFERENCES, section 6: closed forms, 12 digits).
namespace pliant::test::closed_forms_test {

static_assert(Law<Hooke<double>> && Law<Hooke<float>> && LawFromElastic<Hooke<double>>);
static_assert(Law<SaintVenantKirchhoff<double>> && LawFromElastic<SaintVenantKirchhoff<double>>);
static_assert(Law<NeoHookean<double>> && LawFromElastic<NeoHookean<double>>);
static_assert(EnergyIn<Hooke<double>, StrainInvariants>);
static_assert(EnergyIn<SaintVenantKirchhoff<double>, GreenInvariants>);
static_assert(EnergyIn<NeoHookean<double>, CauchyGreenInvariants>);
static_assert(!Law<Elastic> && !Law<double>);

Approx printed(double value) { return Approx(value).epsilon(0).margin(1e-11); }

struct Confined {
  double energy, p11, p22;
};
struct Shear {
  double energy, p11, p22, p33, p12, p21;
};
/// At the stretch l1 with free lateral faces: l2 and P11 in 3D; l2, P11 and P33 in plane strain.
struct Free {
  double l1, uniaxial_l2, uniaxial_p11, plane_l2, plane_p11, plane_p33;
};

template <class L>
void check_states(L const& law, Confined const& confined, Shear const& shear,
                  std::vector<Free> const& free = {}) {
  auto const stretch = diagonal<3>({0.2, 0, 0});
  auto p = stress(law, stretch);
  CHECK(energy_density(law, stretch) == printed(confined.energy));
  CHECK(p(0, 0) == printed(confined.p11));
  CHECK(p(1, 1) == printed(confined.p22));
  CHECK(p(2, 2) == printed(confined.p22));
  CHECK(std::abs(p(0, 1)) + std::abs(p(2, 0)) == 0);
  auto p_in_plane = stress(law, diagonal<2>({0.2, 0, 0}));
  CHECK(energy_density(law, diagonal<2>({0.2, 0, 0})) == printed(confined.energy));
  CHECK(p_in_plane(0, 0) == printed(confined.p11));
  CHECK(p_in_plane(1, 1) == printed(confined.p22));

  Tensor<double, 3> sheared = Tensor<double, 3>::zero();
  sheared(0, 1) = 0.4;
  p = stress(law, sheared);
  CHECK(energy_density(law, sheared) == printed(shear.energy));
  CHECK(p(0, 0) == printed(shear.p11));
  CHECK(p(1, 1) == printed(shear.p22));
  CHECK(p(2, 2) == printed(shear.p33));
  CHECK(p(0, 1) == printed(shear.p12));
  CHECK(p(1, 0) == printed(shear.p21));
  CHECK(std::abs(p(0, 2)) + std::abs(p(2, 1)) == 0);
  p_in_plane = stress(law, Tensor<double, 2>{{{0, 0.4}, {0, 0}}});
  CHECK(p_in_plane(0, 0) == printed(shear.p11));
  CHECK(p_in_plane(0, 1) == printed(shear.p12));
  CHECK(p_in_plane(1, 0) == printed(shear.p21));

  for (auto const& state : free) {
    INFO("stretch " << state.l1);
    p = stress(law, diagonal<3>({state.l1 - 1, state.uniaxial_l2 - 1, state.uniaxial_l2 - 1}));
    CHECK(p(0, 0) == printed(state.uniaxial_p11));
    CHECK(p(1, 1) == printed(0));
    CHECK(p(2, 2) == printed(0));
    p = stress(law, diagonal<3>({state.l1 - 1, state.plane_l2 - 1, 0}));
    CHECK(p(0, 0) == printed(state.plane_p11));
    CHECK(p(1, 1) == printed(0));
    CHECK(p(2, 2) == printed(state.plane_p33));
    p_in_plane = stress(law, diagonal<2>({state.l1 - 1, state.plane_l2 - 1, 0}));
    CHECK(p_in_plane(0, 0) == printed(state.plane_p11));
    CHECK(p_in_plane(1, 1) == printed(0));
  }
}

TEST_CASE("Hooke's law in homogeneous states", "[law]") {
  check_states(law_of_section_6<Hooke>, {.14, 1.4, .6}, {.16, 0, 0, 0, .8, .8},
               {{1.2, .94, 1.04, .914285714286, 1.142857142857, .342857142857}});
}
TEST_CASE("Saint Venant-Kirchhoff in homogeneous states", "[law]") {
  check_states(law_of_section_6<SaintVenantKirchhoff>, {.1694, 1.848, .66},
               {.1824, .56, .56, .24, 1.024, .8},
               {{1.2, .931665175908, 1.3728, .900793301168, 1.508571428571, .377142857143},
                {.7, 1.073778375644, -.9282, 1.103889228397, -1.02, -.437142857143}});
}
TEST_CASE("the neo-Hookean law in homogeneous states", "[law]") {
  check_states(
      law_of_section_6<NeoHookean>, {.125218611520, 1.18913722532, .546964670382},
      {.16, 0, 0, 0, .8, .8},
      {{1.2, .945632624291, .909631566460, .921495438379, .984743595076, .301692314092},
       {.7, 1.107934732848, -2.107198206434, 1.150796046330, -2.383804400713, -.648663080499}});
}

TEST_CASE("the neo-Hookean law of the isochoric part in homogeneous states", "[law]") {
  check_states(
      IsochoricNeoHookean<double>{2, 5}, {.146287898323, 1.43293497263, .940239016422},
      {.16, -.32 / 3, -.32 / 3, -.32 / 3, .8, 2.528 / 3},
      {{1.2, .942559609546, .880898256862, .909018816976, .965216409138, .327810131175},
       {.7, 1.117013463364, -2.369355752576, 1.129489266723, -2.625592789092, -.644989221454}});
}
TEST_CASE("the Mooney-Rivlin law in homogeneous states", "[law]") {
  check_states(MooneyRivlin<double>{.75, .25, 5}, {.145386713755, 1.42054749167, .947671504996},
               {.16, -.4 / 3, -.4 / 3, -.16 / 3, .8, 2.56 / 3},
               {{1.2, .941647717155, .851771181455, .909459014741, .950007854705, .355427418090}});
}
TEST_CASE("Guccione's law in homogeneous states", "[law]") {
  check_states(Guccione<double>{2, 8, 2, 4, 0}.at(Vector<double, 3>{{{1}, {0}, {0}}}),
               {.472851032024, 6.22132275927, 0},
               {.394868296911, .892715710023, .446357855012, 0, 2.41033241706, 2.23178927506});
}

TEST_CASE("Saint Venant-Kirchhoff loses its stiffness at the stretch 1/sqrt(3)", "[law]") {
  // Uniaxial stress: P11 = E l (l² − 1)/2 with l2² = 1 − ν (l² − 1).
  auto const law = law_of_section_6<SaintVenantKirchhoff>;
  double const young = 5.2, poisson = 0.3, critical = 1 / std::sqrt(3.0);
  auto const p11 = [&](double l) {
    double const l2 = std::sqrt(1 - poisson * (l * l - 1));
    return stress(law, diagonal<3>({l - 1, l2 - 1, l2 - 1}))(0, 0);
  };
  CHECK(p11(0.8) == Approx(young * 0.8 * (0.64 - 1) / 2).epsilon(1e-14));
  CHECK(p11(critical) < p11(critical - 0.01));
  CHECK(p11(critical) < p11(critical + 0.01));
}

TEST_CASE("a rest state has no energy and no stress", "[law]") {
  on_each_law<Ask::energy_and_stress>([](auto law, auto dim) {
    auto const rest = Tensor<double, dim()>::zero();
    CHECK(energy_density(law, rest) == 0);
    CHECK(largest<dim()>(stress(law, rest)) == 0);
  });
}

TEST_CASE("laws take their parameters from Young's modulus and Poisson's ratio", "[law]") {
  Elastic const material{5.2, 0.3, 1};
  CHECK(material.lame_lambda() == Approx(3).epsilon(1e-15));
  CHECK(material.lame_mu() == Approx(2).epsilon(1e-15));
  auto const check = [&](auto law) {
    CHECK(static_cast<double>(law.lambda) == Approx(3).epsilon(1e-7));
    CHECK(static_cast<double>(law.mu) == Approx(2).epsilon(1e-7));
  };
  check(Hooke<double>::from(material));
  check(SaintVenantKirchhoff<float>::from(material));
  check(NeoHookean<double>::from(material));
}

}  // namespace pliant::test::closed_forms_test

#include "support/laws.hpp"

// Homogeneous states with λ = 3, μ = 2 (REFERENCES, section 6: closed forms, 12 digits).
namespace pliant::test {

static_assert(Law<Hooke<double>> && Law<Hooke<float>> && LawFromElastic<Hooke<double>>);
static_assert(Law<SaintVenantKirchhoff<double>> && LawFromElastic<SaintVenantKirchhoff<double>>);
static_assert(Law<NeoHookean<double>> && LawFromElastic<NeoHookean<double>>);
static_assert(EnergyIn<Hooke<double>, StrainInvariants>);
static_assert(EnergyIn<SaintVenantKirchhoff<double>, GreenInvariants>);
static_assert(EnergyIn<NeoHookean<double>, CauchyGreenInvariants>);
static_assert(!Law<Elastic> && !Law<double>);

Approx printed(double value) { return Approx(value).epsilon(0).margin(6e-12); }

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

template <template <class> class L>
void check_states(Confined const& confined, Shear const& shear, std::vector<Free> const& free) {
  auto const law = law_of_section_6<L>;
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
  check_states<Hooke>({.14, 1.4, .6}, {.16, 0, 0, 0, .8, .8},
                      {{1.2, .94, 1.04, .914285714286, 1.142857142857, .342857142857}});
}
TEST_CASE("Saint Venant-Kirchhoff in homogeneous states", "[law]") {
  check_states<SaintVenantKirchhoff>(
      {.1694, 1.848, .66}, {.1824, .56, .56, .24, 1.024, .8},
      {{1.2, .931665175908, 1.3728, .900793301168, 1.508571428571, .377142857143},
       {.7, 1.073778375644, -.9282, 1.103889228397, -1.02, -.437142857143}});
}
TEST_CASE("the neo-Hookean law in homogeneous states", "[law]") {
  check_states<NeoHookean>(
      {.125218611520, 1.18913722532, .546964670382}, {.16, 0, 0, 0, .8, .8},
      {{1.2, .945632624291, .909631566460, .921495438379, .984743595076, .301692314092},
       {.7, 1.107934732848, -2.107198206434, 1.150796046330, -2.383804400713, -.648663080499}});
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
  on_each_law([](auto law, auto dim) {
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

}  // namespace pliant::test

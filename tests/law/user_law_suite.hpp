#pragma once

#include "support/flat.hpp"
#include "support/formulations.hpp"

// Laws as a user writes them: the energy, once.
namespace pliant::test::user_law_suite {

/// Saint Venant-Kirchhoff, in the displacement gradient.
template <class T>
struct OfGradient {
  T lambda, mu;
  template <class S>
  PLIANT_HOST_DEVICE S energy(Tensor<S, 3> const& h) const {
    auto const e = symmetric_part(h + T(0.5) * (transpose(h) * h));
    return lambda / 2 * square(trace(e)) + mu * dot(e, e);
  }
  static OfGradient from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};
/// The neo-Hookean law as it is printed.
template <class T>
struct OfInvariants {
  T lambda, mu;
  template <class S>
  PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const {
    S const log_j = log1p(i.J_minus_1);
    return mu / 2 * i.I1_minus_3() - mu * log_j + lambda / 2 * square(log_j);
  }
  static OfInvariants from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};
/// Hooke's law with the stress written by hand, which is then what forces come from; and without
/// parameters of a material.
template <class T>
struct ByHand {
  T modulus;
  template <class S>
  PLIANT_HOST_DEVICE S energy(StrainInvariants<S> const& e) const {
    return modulus * e.squares;
  }
  template <class S, int Dim>
  PLIANT_HOST_DEVICE Tensor<S, Dim> stress(Tensor<S, Dim> const& h) const {
    return 2 * modulus * symmetric_part(h);
  }
};
static_assert(EnergyInGradient<OfGradient<double>> && Law<OfGradient<float>>);
static_assert(LawFromElastic<OfInvariants<double>>);
static_assert(Law<ByHand<double>> && !LawFromElastic<ByHand<double>>);

/// Holds the body of a user's law to that of the built-in one.
template <class Own, class BuiltIn, class B>
void check_same(B const& backend, Group<Own> own, Group<BuiltIn> built_in) {
  using T = typename B::scalar;
  auto const mesh = distorted_mesh<typename Own::element>(4);
  Body body{backend, mesh, soft, own};
  Body other{backend, mesh, soft, built_in};
  Random random(1);
  auto const u = random.field<Own::dim>(mesh.nodes.size(), 0.03);
  auto const du = random.field<Own::dim>(mesh.nodes.size(), 1);

  auto const f = forces_at(body, u), df = tangent_product(body, u, du);

  double const epsilon = 64 * double{std::numeric_limits<T>::epsilon()};
  CHECK(largest(f) > 1e-3);
  CHECK(difference(f, forces_at(other, u)) < epsilon * largest(f));
  CHECK(difference(df, tangent_product(other, u, du)) < epsilon * largest(df));
  CHECK(strain_energy(body) == Approx(strain_energy(other)).epsilon(epsilon));
}

TEST_CASE("a user's law is as good as a built-in one", "[law]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    check_same(backend, Group<Formulation<Quad4, Gauss<2>, OfGradient>>{},
               Group<Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>>{});
    check_same(backend, Group<Formulation<Tet4, Gauss<1>, OfGradient>>{},
               Group<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>>{});
    check_same(backend, Group<Formulation<Quad4, Gauss<2>, OfInvariants>>{},
               Group<Formulation<Quad4, Gauss<2>, NeoHookean>>{});
    check_same(backend, Group<Formulation<Quad4, Gauss<2>, ByHand>>{ByHand<double>{2}},
               Group<Formulation<Quad4, Gauss<2>, Hooke>>{Hooke<double>{0, 2}});
  });
}

TEST_CASE("a law that takes nothing from an Elastic needs its parameters", "[law]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    CHECK_THROWS_WITH((Body{backend, regular_mesh<Quad4>(2), soft,
                            Group<Formulation<Quad4, Gauss<2>, ByHand>>{}}),
                      says("Group<F>{law}"));
  });
}

}  // namespace pliant::test::user_law_suite

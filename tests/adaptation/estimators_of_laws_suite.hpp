#pragma once

#include "adaptation/criteria.hpp"
#include "support/law_formulations.hpp"

namespace pliant::test::estimators_of_laws_suite {

template <class... Fs, class Visit>
void on_laws(List<Fs...>, Visit const& visit) {
  (visit(List<Fs>{}), ...);
}

TEST_CASE("under every law uniform deformation has no error, and other deformation has",
          "[estimator]") {
  on_laws(LawFormulations{}, []<class F>(List<F>) {
    CAPTURE(formulation_name<F>());
    using E = typename F::element;
    auto const mesh = distorted_mesh<E>(2);
    auto body = body_among<F, LawFormulations>(MainBackend{}, mesh);
    auto const h = Random(4).tensor<F::dim>(0.05);
    body.set_displacements(uniform(mesh.nodes, h));
    double const of_uniform = estimate(body, RecoveredStress{}), energy = strain_energy(body);
    auto const stress_of_uniform = evaluate<E>(body, VonMises{});
    auto bent = uniform(mesh.nodes, h);
    for (std::size_t i = 0; i < bent.size(); ++i)
      bent[i][0] += 0.05 * square(mesh.nodes[i][1]) * mesh.nodes[i][0];
    body.set_displacements(bent);

    double const of_bent = estimate(body, RecoveredStress{});

    CHECK(of_uniform < 1e-20 * energy);
    CHECK(of_bent > 1e-8 * energy);
    CHECK(of_bent < 0.5 * strain_energy(body));
    for (double s : stress_of_uniform) CHECK(s == Approx(stress_of_uniform.front()).epsilon(1e-6));
    CHECK(stress_of_uniform.front() > 0);
  });
}

TEST_CASE("laws with values per element and with internal variables have discrepancies",
          "[estimator]") {
  using Graded = Formulation<Tri3, Gauss<1>, PerElement<NeoHookean>::law>;
  using Small = Formulation<Tri3, Gauss<1>, Hooke>;
  using Viscous = Formulation<Tri3, Gauss<1>, KelvinVoigt<NeoHookean>::law>;
  auto const mesh = distorted_mesh<Tri3>(2);
  Group<Graded> graded;
  graded.values = {{3, 2}};  // of the material `soft`
  Group<Viscous> viscous{KelvinVoigt<NeoHookean>::law<double>{NeoHookean<double>::from(soft), 0.1}};
  Body body{MainBackend{}, mesh, soft, Group<Small>{}, graded, viscous};
  auto h = Tensor<double, 2>::zero();
  h(0, 0) = 0.2;
  body.set_displacements(uniform(mesh.nodes, h));
  std::vector<Index> all(mesh.elements<Tri3>().size());
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
  // REFERENCES, section 6: P11 and P22 of both laws.
  double const off = square(1.18913722532 - 1.4) + square(0.546964670382 - 0.6);
  auto const is = Approx(off / (2 * 5.2)).epsilon(1e-9);

  CHECK(estimate(body, LawDiscrepancy<Graded>{}) == is);
  body.assign<Graded>(all);
  CHECK(estimate(body, LawDiscrepancy<Small>{}) == is);
  body.assign<Viscous>(all);
  CHECK(detail::young_at_rest(body.parts().law_of<Viscous>()) == Approx(5.2));
  CHECK(estimate(body, RecoveredStress{}) < 1e-20);
}

}  // namespace pliant::test::estimators_of_laws_suite

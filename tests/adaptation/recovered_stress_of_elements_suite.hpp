#pragma once

#include "adaptation/estimates.hpp"

// Over the elements of the catalogue and their schemes.
namespace pliant::test::recovered_stress_of_elements_suite {

static_assert(CriterionOfMeans<RecoveredStress, Formulation<Tet10, Gauss<2>, NeoHookean>>);

using Everything =
    List<Formulation<Tri3, Gauss<1>, Hooke>, Formulation<Quad4, Gauss<2>, NeoHookean>,
         Formulation<Quad4, OnePoint, SaintVenantKirchhoff>,
         Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>, Formulation<Quad4, FBar<Gauss<2>>, Hooke>,
         Formulation<Tri6, Gauss<2>, NeoHookean>,
         Formulation<Quad8, Gauss<3>, SaintVenantKirchhoff>,
         Formulation<Quad9, FBar<Gauss<3>>, NeoHookean>, Formulation<Tet4, Gauss<1>, NeoHookean>,
         Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>, Formulation<Hex8, OnePoint, Hooke>,
         Formulation<Wedge6, Gauss<2>, Hooke>, Formulation<Pyramid5, Gauss<2>, NeoHookean>,
         Formulation<Tet10, Gauss<2>, Hooke>, Formulation<Hex20, Gauss<3>, Hooke>>;

TEST_CASE("uniform stress has no error, and other stress has", "[estimator]") {
  on_formulations(Everything{}, []<class F>(List<F>) {
    CAPTURE(formulation_name<F>());
    auto const mesh = distorted_mesh<typename F::element>(3);
    Tensor<double, F::dim> const h = Random(4).tensor<F::dim>(0.1);
    auto body = body_among<F, Everything>(MainBackend{}, mesh);

    body.set_displacements(uniform(mesh.nodes, h));
    double const of_uniform = estimate(body, RecoveredStress{}), energy = strain_energy(body);
    body.set_displacements(smooth_field(mesh.nodes, 0.02));
    double const of_smooth = estimate(body, RecoveredStress{});

    CHECK(of_uniform >= 0);
    CHECK(of_uniform < 1e-24 * energy);
    CHECK(of_smooth > 1e-4 * strain_energy(body));
    CHECK(of_smooth < strain_energy(body));
  });
}

TEST_CASE("backends agree on estimates", "[estimator]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    double const tolerance = sizeof(typename B::scalar) == 4 ? 2e-3 : 1e-10;
    on_formulations(List<Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>,
                         Formulation<Hex8, OnePoint, SaintVenantKirchhoff>,
                         Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>>{},
                    [&]<class F>(List<F>) {
                      CAPTURE(formulation_name<F>());
                      auto const mesh = distorted_mesh<typename F::element>(3);
                      auto const u = Random(5).field<F::dim>(mesh.nodes.size(), 0.02);

                      auto const found = estimates<F>(backend, mesh, u),
                                 expected = estimates<F>(Reference<double>{}, mesh, u);

                      for (std::size_t e = 0; e < found.size(); ++e)
                        CHECK(found[e] == Approx(expected[e]).epsilon(tolerance));
                    });
  });
}

TEST_CASE("solids of quadratic elements see the part of the stress that is quadratic",
          "[estimator]") {
  auto const check = []<Element E>(E) {
    using F = Formulation<E, Gauss<3>, Hooke>;
    auto const mesh = mesh::box<E>({.size = {5, 1, 1}, .cells = {5, 1, 1}});
    Body body{MainBackend{}, mesh, soft, Group<F>{Hooke<double>{0, 1}}};
    auto u = mesh.nodes;
    for (auto& p : u) p = {p[0] * p[0] * p[0] / 6, 0, 0};
    body.set_displacements(u);
    double const exact = 0.5 / 2 * (4.0 / 45) / 16;  // as in the plane: see recovered_stress
    CHECK(evaluate<E>(body, RecoveredStress{})[2] == Approx(exact).epsilon(1e-10));
  };
  check(Hex20{});
  check(Hex27{});
}

}  // namespace pliant::test::recovered_stress_of_elements_suite

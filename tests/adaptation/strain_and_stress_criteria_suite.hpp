#pragma once

#include "adaptation/criteria.hpp"

// Values in closed form, and printed ones of REFERENCES, section 6.
namespace pliant::test::strain_and_stress_criteria_suite {

/// A criterion of a body of one formulation in a uniform state, whose elements all have the same.
template <class F, class B, class C>
double in_uniform(B const& backend, Tensor<double, F::dim> const& h,
                  typename F::template law<double> const& law, C const& criterion) {
  auto const mesh = distorted_mesh<typename F::element>(2);
  Body body{backend, mesh, soft, Group<F>{law}};
  body.set_displacements(uniform(mesh.nodes, h));
  auto const values = evaluate<typename F::element>(body, criterion);
  for (double v : values) CHECK(v == Approx(values[0]).epsilon(1e-4).margin(1e-6));
  return values[0];
}
template <int Dim>
Tensor<double, Dim> only(int i, int j, double value) {
  auto h = Tensor<double, Dim>::zero();
  h(i, j) = value;
  return h;
}

TEST_CASE("von Mises's stress and the energy density have their printed values", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    double const epsilon = sizeof(typename B::scalar) == 4 ? 2e-5 : 1e-9;
    Hooke<double> const hooke{3, 2};
    NeoHookean<double> const rubber{3, 2};
    using Plane = Formulation<Quad4, Gauss<2>, Hooke>;
    using Solid = Formulation<Hex8, Gauss<2>, NeoHookean>;
    using PlaneRubber = Formulation<Tri3, Gauss<1>, NeoHookean>;
    using Sheet = Formulation<Quad4, Gauss<2>, PlaneStress<Hooke>::law>;
    auto const is = [&](double value) { return Approx(value).epsilon(epsilon); };

    // Simple shear of Hooke's law: σ12 = 0.8.
    CHECK(in_uniform<Plane>(backend, only<2>(0, 1, 0.4), hooke, VonMises{}) ==
          is(std::sqrt(3) * 0.8));
    CHECK(in_uniform<Plane>(backend, only<2>(0, 1, 0.4), hooke, EnergyDensity{}) == is(0.16));
    // Confined: σ11 = 1.4, σ22 = σ33 = 0.6.
    CHECK(in_uniform<Plane>(backend, only<2>(0, 0, 0.2), hooke, VonMises{}) == is(0.8));
    // P11 and P22 of the neo-Hookean law, J = 1.2.
    double const confined = 1.18913722532 - 0.546964670382 / 1.2;
    CHECK(in_uniform<Solid>(backend, only<3>(0, 0, 0.2), rubber, VonMises{}) == is(confined));
    CHECK(in_uniform<PlaneRubber>(backend, only<2>(0, 0, 0.2), rubber, VonMises{}) == is(confined));
    CHECK(in_uniform<Solid>(backend, only<3>(0, 0, 0.2), rubber, EnergyDensity{}) ==
          is(0.125218611520));
    // Plane stress: σ11 = E/(1 − ν²) 0.1, σ22 = ν σ11.
    double const pull = 5.2 / (1 - 0.09) * 0.1;
    CHECK(in_uniform<Sheet>(backend, only<2>(0, 0, 0.1), {{hooke}}, VonMises{}) ==
          is(pull * std::sqrt(1 - 0.3 + 0.09)));
  });
}

TEST_CASE("strains are those of the stretch, whatever the rotation", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(2);
    double const tolerance = sizeof(typename B::scalar) == 4 ? 1e-5 : 1e-12;
    auto stretch = Tensor<double, E::dim>::identity();
    stretch(0, 0) = 0.8;
    stretch(1, 1) = 1.3;
    double squares = square((0.64 - 1) / 2) + square((1.69 - 1) / 2);
    auto const q = turn<E::dim>(0.4, {1, -1, 2}), r = turn<E::dim>(2.1, {3, 1, 1});
    auto const f = r * (q * stretch * transpose(q));
    auto const u = uniform(mesh.nodes, less_identity(f));

    for (double v : values_at<E>(backend, mesh, u, Compression{}))
      CHECK(v == Approx(0.2).epsilon(tolerance));
    for (double v : values_at<E>(backend, mesh, u, StrainNorm{}))
      CHECK(v == Approx(std::sqrt(squares)).epsilon(tolerance));
    auto const swollen = uniform(mesh.nodes, 0.1 * Tensor<double, E::dim>::identity());
    for (double v : values_at<E>(backend, mesh, swollen, Compression{}))
      CHECK(v == Approx(-0.1).epsilon(10 * tolerance));
  });
}

TEST_CASE("rotation leaves von Mises's stress alone", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
    auto f = Tensor<double, 3>::identity() + Random(4).tensor<3>(0.2);
    auto const turned = turn<3>(1.3, {1, 2, 3}) * f;
    SaintVenantKirchhoff<double> const law{3, 2};
    double const before = in_uniform<F>(backend, less_identity(f), law, VonMises{});
    CHECK(before > 0.1);
    CHECK(in_uniform<F>(backend, less_identity(turned), law, VonMises{}) == Approx(before));
  });
}

TEST_CASE("von Mises's stress of an inverted element is NaN", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, StableNeoHookean>;
    auto const mesh = regular_mesh<Tri3>(2);
    auto body = body_of<F>(backend, mesh);
    body.set_displacements(uniform(mesh.nodes, only<2>(0, 0, -1.5)));
    for (double v : evaluate<Tri3>(body, VonMises{})) CHECK(std::isnan(v));
  });
}

}  // namespace pliant::test::strain_and_stress_criteria_suite

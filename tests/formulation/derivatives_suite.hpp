#pragma once

#include "support/difference_quotient.hpp"
#include "support/flat.hpp"
#include "support/formulations.hpp"

namespace pliant::test::derivatives_suite {

/// Displacements with a strain of about 0.1 from element to element, about the stretch at which a law is
/// smooth.
template <class F, class M>
FieldOf<M::dim> rough_state(M const& mesh, int n, unsigned seed) {
  Random random(seed);
  auto h = random.tensor<M::dim>(0.1);
  using S = Sample<typename F::template law<double>>;
  if constexpr (requires { S::smooth_at; })
    for (int i = 0; i < M::dim; ++i) h(i, i) += S::smooth_at - 1;
  return plus(uniform(mesh.nodes, h), 1, random.field<M::dim>(mesh.nodes.size(), 0.05 / n));
}

template <class TheBody>
double energy_at(TheBody& body, FieldOf<TheBody::dim> const& u) {
  body.set_displacements(u);
  return strain_energy(body);
}

TEST_CASE("forces are minus the derivative of the energy", "[formulation]") {
  on_each_formulation<MainAlone>([]<class B, class F>(Case<B, F>) {
    if constexpr (internal_variables_of<F> > 0) return;  // dashpots have no energy
    int const n = F::dim == 2 ? 4 : 3;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_among_all<F>(B{}, mesh);
    for (unsigned seed = 1; seed <= 3; ++seed) {
      auto const u = rough_state<F>(mesh, n, seed);
      auto const along = Random(seed + 10).field<F::dim>(u.size(), 1.0);
      auto const f = forces_at(body, u);

      double const slope =
          derivative([&](double h) { return energy_at(body, plus(u, h, along)); }, 1e-3 / n);

      double const scale = std::sqrt(inner(f, f) * inner(along, along));
      CHECK(slope == Approx(-inner(f, along)).epsilon(0).margin(1e-8 * scale));
      CHECK(std::abs(slope) > 1e-4 * scale);
    }
  });
}

TEST_CASE("the tangent product is the derivative of the forces", "[formulation]") {
  on_each_formulation<MainAlone>([]<class B, class F>(Case<B, F>) {
    int const n = F::dim == 2 ? 4 : 3;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_among_all<F>(B{}, mesh);
    for (unsigned seed = 1; seed <= 2; ++seed) {
      auto const u = rough_state<F>(mesh, n, seed);
      auto const along = Random(seed + 10).field<F::dim>(u.size(), 1.0);

      auto const product = tangent_product(body, u, along);

      auto const differences = field_derivative<F::dim>(
          [&](double h) { return forces_at(body, plus(u, h, along)); }, 1e-3 / n);
      CHECK(largest(product) > 0.1);
      CHECK(difference(product, differences) < 1e-8 * largest(product));
    }
  });
}

TEST_CASE("the tangent is symmetric", "[formulation]") {
  on_each_formulation<MainAlone>([]<class B, class F>(Case<B, F>) {
    int const n = F::dim == 2 ? 6 : 4;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_among_all<F>(B{}, mesh);
    auto const u = rough_state<F>(mesh, n, 1);
    auto const x = Random(2).field<F::dim>(u.size(), 1.0);
    auto const y = Random(3).field<F::dim>(u.size(), 1.0);

    auto const kx = tangent_product(body, u, x), ky = tangent_product(body, u, y);

    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    double const scale = std::sqrt(inner(x, x) * inner(ky, ky));
    CHECK(inner(x, ky) == Approx(inner(y, kx)).epsilon(0).margin(16 * epsilon * scale));
    CHECK(std::abs(inner(x, ky)) > 1e-4 * scale);
  });
}

}  // namespace pliant::test::derivatives_suite

#pragma once

#include "support/formulations.hpp"

namespace pliant::test::balance_suite {

TEST_CASE("inner forces and their moments add up to zero", "[formulation]") {
  on_each_formulation<PairedBackends>([]<class B, class F>(Case<B, F>) {
    using T = typename B::scalar;
    int const n = F::dim == 2 ? 8 : 4;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_among_all<F>(B{}, mesh);
    auto const u = Random(1).field<F::dim>(mesh.nodes.size(), 0.1 / n);

    auto const f = forces_at(body, u);

    double const rounding = 4 * double{std::numeric_limits<T>::epsilon()} * largest(f) *
                            std::sqrt(static_cast<double>(f.size()));
    for (double x : total(f)) CHECK(std::abs(x) < rounding);
    // About positions as they are now; Hooke's law keeps no moment but that about those at rest.
    auto const arms = small_strain<F> ? mesh.nodes : plus(mesh.nodes, 1, rounded<T>(u));
    for (double x : moment(arms, f)) CHECK(std::abs(x) < rounding * largest(arms));
    CHECK(largest(f) > 1e-3);
  });
}

TEST_CASE("masses add up to density times volume, about the right centre", "[formulation]") {
  on_each_formulation<PairedBackends>([]<class B, class F>(Case<B, F>) {
    auto const mesh = distorted_mesh<typename F::element>(5);

    auto const body = body_among_all<F>(B{}, mesh);
    auto const& masses = body.parts().layout.mass_list();

    double sum = 0;
    Point<F::dim> centre{};
    for (std::size_t i = 0; i < masses.size(); ++i) {
      sum += masses[i];
      for (std::size_t k = 0; k < F::dim; ++k) centre[k] += masses[i] * mesh.nodes[i][k];
    }
    CHECK(sum == Approx(soft.density).epsilon(1e-14));
    CHECK(std::ranges::min(masses) > 0);
    // Row sums keep the first moment: Σ m_a X_a = ρ ∫ Σ N_a X_a dV = ρ ∫ X dV; so does Simpson's rule.
    // Diagonal scaling does where opposite nodes get the same share.
    using E = typename F::element;
    if (E::lumping == Lumping::diagonal && !SimplexCell<typename E::cell>) return;
    Point<3> const middle{0.25, 1, 0.625};
    for (std::size_t k = 0; k < F::dim; ++k)
      CHECK(centre[k] / sum == Approx(middle[k]).epsilon(1e-14));
  });
}

}  // namespace pliant::test::balance_suite

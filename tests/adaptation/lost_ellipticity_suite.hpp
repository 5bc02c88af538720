#pragma once

#include "support/formulations.hpp"

// A law that loses strong ellipticity is not switched to.
namespace pliant::test::lost_ellipticity_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Bricks = Formulation<Hex8, Gauss<2>, Hooke>;
using TurningBricks = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
static_assert(Criterion<LeastAcousticEigenvalue<Turning>, Linear>);

/// A stretch along the first axis, 1 along others.
template <int Dim>
Tensor<double, Dim> stretch(double along) {
  auto h = Tensor<double, Dim>::zero();
  h(0, 0) = along - 1;
  return h;
}

/// Of Saint Venant-Kirchhoff's law, Q(N) = (N·S N) I + F ((λ + μ) N⊗N + μ I) Fᵀ, in the plane, over many directions.
inline double least_in_plane(double lambda, double mu, double along) {
  double const strain = (along * along - 1) / 2;
  double least = 1e9;
  for (int k = 0; k < 10000; ++k) {
    double const angle = 3.141592653589793 * k / 10000, c = std::cos(angle), s = std::sin(angle);
    double const pull = (lambda + 2 * mu) * strain * c * c + lambda * strain * s * s;
    double const q00 = pull + along * along * ((lambda + mu) * c * c + mu),
                 q11 = pull + (lambda + mu) * s * s + mu, q01 = along * (lambda + mu) * c * s;
    least = std::min(least, (q00 + q11) / 2 - std::sqrt(square((q00 - q11) / 2) + square(q01)));
  }
  return least;
}

TEST_CASE("the least eigenvalue of the acoustic tensor is in closed form under stretch",
          "[adaptation]") {
  double const lambda = 3, mu = 2;
  SaintVenantKirchhoff<double> const svk{lambda, mu};
  for (double along : {0.95, 0.9, 0.8, 0.7, 0.65, 0.6, 0.5}) {
    double const exact = least_in_plane(lambda, mu, along),
                 found = least_acoustic_eigenvalue(svk, stretch<2>(along)),
                 in_space = least_acoustic_eigenvalue(svk, stretch<3>(along));
    CHECK(found >= exact - 1e-12);
    CHECK(found <= exact + 0.02 * mu);
    CHECK(in_space >= exact - 1e-12);  // the third axis adds nothing less
    CHECK(in_space <= exact + 0.1 * mu);
  }
  CHECK(least_acoustic_eigenvalue(svk, stretch<2>(0.8)) > 0);
  CHECK(least_acoustic_eigenvalue(svk, stretch<3>(0.8)) > 0);
  CHECK(least_acoustic_eigenvalue(svk, stretch<2>(0.6)) < 0);
  CHECK(least_acoustic_eigenvalue(svk, stretch<3>(0.6)) < 0);
  auto const check = [&]<int Dim>(std::integral_constant<int, Dim>) {
    CHECK(least_acoustic_eigenvalue(svk, stretch<Dim>(1)) == Approx(mu));
    CHECK(least_acoustic_eigenvalue(Hooke<double>{lambda, mu}, stretch<Dim>(0.5)) == Approx(mu));
    CHECK(std::isnan(least_acoustic_eigenvalue(NeoHookean<double>{lambda, mu}, stretch<Dim>(-1))));
  };
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
}

TEST_CASE("no choice goes to a law that is not elliptic where the element is", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const check = [&]<class Cheap, class Other>(List<Cheap, Other>, auto const& mesh) {
      using E = typename Cheap::element;
      for (bool lost : {false, true}) {
        Body body{backend, mesh, Elastic{5.2, 0.3, 1}, Group<Other>{Hooke<double>{3, 2}},
                  Group<Cheap>{SaintVenantKirchhoff<double>{3, 2}}};
        body.set_displacements(uniform(mesh.nodes, stretch<E::dim>(lost ? 0.6 : 0.8)));

        Adaptation{cheapest<Cheap, Other>({.tolerance = 1e3})}.now(body);

        auto const groups = body.template groups_of<E>();
        CHECK(std::ranges::count(groups, lost ? 0 : 1) == static_cast<long>(groups.size()));
        CHECK(ledger(body).empty() == lost);
      }
    };
    check(List<Turning, Linear>{}, distorted_mesh<Quad4>(4));
    check(List<TurningBricks, Bricks>{}, distorted_mesh<Hex8>(2));
  });
}

TEST_CASE("a rule may ask that a law is elliptic", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    Body body{backend, mesh, Elastic{5.2, 0.3, 1}, Group<Linear>{Hooke<double>{3, 2}},
              Group<Turning>{SaintVenantKirchhoff<double>{3, 2}}};
    Adaptation adapt{
        when<Linear>(LeastAcousticEigenvalue<Turning>{}).above(0).template become<Turning>()};
    body.set_displacements(uniform(mesh.nodes, stretch<2>(0.6)));
    adapt.now(body);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), 1) == 0);
    body.set_displacements(uniform(mesh.nodes, stretch<2>(0.8)));
    adapt.now(body);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), 0) == 0);
  });
}

}  // namespace pliant::test::lost_ellipticity_suite

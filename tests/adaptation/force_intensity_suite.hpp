#pragma once

#include <Eigen/Dense>

#include "adaptation/criteria.hpp"

namespace pliant::test::force_intensity_suite {

/// Σ_i w_i (det J_i) Σ_j N_j(ξ_i) |F_j| / A by direct summation, forces from the body.
template <class F, class TheBody>
double direct_intensity(TheBody& body, PointWeights weights) {
  using E = typename F::element;
  auto const f = body.forces();
  auto const x = plus(body.mesh().nodes, 1, body.displacements());
  constexpr auto rule = F::quadrature::template rule<typename E::cell>();
  double sum = 0, size = 0;
  for (std::size_t q = 0; q < std::size(rule.points); ++q) {
    Vector<double, E::dim> xi;
    for (int k = 0; k < E::dim; ++k) xi[k] = rule.points[q][k];
    auto const n = E::shape(xi);
    auto const g = shape_gradient<E>(xi);
    Eigen::Matrix<double, E::dim, E::dim> j = j.Zero();
    double pull = 0;
    for (int a = 0; a < E::nodes; ++a) {
      double squared = 0;
      for (int i = 0; i < E::dim; ++i) {
        double const own = f[static_cast<std::size_t>(a)][static_cast<std::size_t>(i)];
        squared += own * own;
        for (int k = 0; k < E::dim; ++k)
          j(i, k) += x[static_cast<std::size_t>(a)][static_cast<std::size_t>(i)] * g(a, k);
      }
      pull += n[a] * std::sqrt(squared);
    }
    double const volume = rule.weights[q] * j.determinant();
    size += volume;
    sum += pull * (weights == PointWeights::volume ? volume : rule.weights[q]);
  }
  return sum / size;
}

template <class F, class B>
void check_intensity(B const& backend) {
  using E = typename F::element;
  INFO(formulation_name<F>());
  double const tolerance = 256 * double{std::numeric_limits<typename B::scalar>::epsilon()};
  auto const whole = distorted_mesh<E>(3);
  for (std::size_t e = 0; e < 4; ++e) {
    std::vector<Point<E::dim>> nodes;
    for (Index node : whole.template elements<E>()[e])
      nodes.push_back(whole.nodes[static_cast<std::size_t>(node)]);
    auto body = body_of<F>(backend, single<E>(nodes));
    body.set_displacements(Random(static_cast<unsigned>(e) + 1).field<E::dim>(nodes.size(), 0.05));

    auto const by_volume = evaluate<E>(body, ForceIntensity<>{}),
               by_rule = evaluate<E>(body, ForceIntensity<PointWeights::rule>{});

    double const expected = direct_intensity<F>(body, PointWeights::volume),
                 printed = direct_intensity<F>(body, PointWeights::rule);
    CHECK(by_volume[0] == Approx(expected).epsilon(tolerance));
    CHECK(by_rule[0] == Approx(printed).epsilon(tolerance));
    CHECK(expected > 1e-3);
    CHECK(printed > 4 * expected);  // cells are small: their weights add up to more than their size
  }
}

TEST_CASE("R_S is its sum over points and nodes", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_intensity<Formulation<Tri3, Gauss<1>, Hooke>>(backend);
    check_intensity<Formulation<Tri3, Gauss<2>, SaintVenantKirchhoff>>(backend);
    check_intensity<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend);
    check_intensity<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend);
    check_intensity<Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>>(backend);
  });
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    check_intensity<Formulation<Tri3, Gauss<1>, Hooke>>(backend);
    check_intensity<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend);
  });
}

TEST_CASE("R_S asks each element's own law", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Soft = Formulation<Quad4, Gauss<2>, Hooke>;
    using Stiff = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
    auto const mesh = distorted_mesh<Quad4>(4);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    Body body{backend, mesh, soft, Group<Soft>{}, Group<Stiff>{{{300, 200}}}};
    body.set_displacements(u);
    body.template assign<Stiff>({1, 4});
    std::vector<Index> all(mesh.elements<Quad4>().size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);

    auto const value = evaluate<Quad4>(body, ForceIntensity<>{});

    body.template assign<Soft>(all);
    auto const a = evaluate<Quad4>(body, ForceIntensity<>{});
    body.template assign<Stiff>(all);
    auto const b = evaluate<Quad4>(body, ForceIntensity<>{});
    for (std::size_t e = 0; e < value.size(); ++e)
      CHECK(value[e] == Approx(e == 1 || e == 4 ? b[e] : a[e]).epsilon(1e-12));
    CHECK(b[1] > 10 * a[1]);
  });
}

}  // namespace pliant::test::force_intensity_suite

#pragma once

#include <limits>

#include "adaptation/criteria.hpp"

// What a check leaves out because the displacement gradient is small is what could not act.
namespace pliant::test::bounded_criteria_suite {

/// Linear displacements u = H X with H:H = norm², in random directions: shears, stretches, rotations.
template <int Dim>
Tensor<double, Dim> random_gradient(Random& random, double norm) {
  auto h = random.tensor<Dim>(1);
  switch (random.below(4)) {
    case 0:  // a turn
      for (int i = 0; i < Dim; ++i)
        for (int k = 0; k <= i; ++k) h(k, i) = i == k ? 0 : -h(i, k);
      break;
    case 1:  // a stretch along one axis
      for (int i = 0; i < Dim; ++i)
        for (int k = 0; k < Dim; ++k) h(i, k) = i == 0 && k == 0 ? h(i, k) : 0;
      break;
    case 2:  // the same along all
      for (int i = 0; i < Dim; ++i)
        for (int k = 0; k < Dim; ++k) h(i, k) = i == k ? h(0, 0) : 0;
      break;
    default:
      break;
  }
  return (norm / std::sqrt(dot(h, h))) * h;
}

template <class E, class C>
void check_bound(C const& criterion, Random& random) {
  Reference<double> const backend{};
  auto const mesh = distorted_mesh<E>(2);
  for (int k = 0; k < 2000; ++k) {
    double const norm = std::pow(10.0, 1.75 * random() - 1.25);
    auto const h = random_gradient<E::dim>(random, norm);
    double most = 0;
    for (double value : values_at<E>(backend, mesh, uniform(mesh.nodes, h), criterion))
      most = std::max(most, value);
    CAPTURE(norm, most);
    REQUIRE(criterion.least_gradient(most, E::dim) <= norm * (1 + 1e-9));
  }
}

TEST_CASE("elements have the gradient that a criterion's value asks at the least", "[adaptation]") {
  Random random(5);
  auto const all = [&]<class E>(E) {
    check_bound<E>(EdgeLengthRatio{}, random);
    check_bound<E>(AreaRatio{}, random);
    check_bound<E>(Rotation{}, random);
    check_bound<E>(StrainNorm{}, random);
    check_bound<E>(Compression{}, random);
    check_bound<E>(largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{}), random);
  };
  all(Tri3{});
  all(Tet4{});
}

TEST_CASE("a check moves what its criterion says, however much it leaves out", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const on = [&]<class E>(E, auto const& criterion) {
      using T = typename B::scalar;
      using Cheap = Formulation<E, Gauss<LinearSimplex<E> ? 1 : 2>, Hooke>;
      using Dear = Formulation<E, Gauss<LinearSimplex<E> ? 1 : 2>, SaintVenantKirchhoff>;
      auto const mesh = distorted_mesh<E>(6);
      for (double size : {1e-3, 1e-2, 3e-2}) {
        auto const u = rounded<float>(Random(7).field<E::dim>(mesh.nodes.size(), size));
        double const threshold = 0.05;
        Body body{backend, mesh, soft, Group<Cheap>{}, Group<Dear>{}};
        body.set_displacements(u);
        Body back{backend, mesh, soft, Group<Dear>{}, Group<Cheap>{}};
        back.set_displacements(u);
        auto const value = evaluate<E>(body, criterion);
        Adaptation{when<Cheap>(criterion).above(threshold).template become<Dear>()}.now(body);
        Adaptation{when<Dear>(criterion).below(1.2 * threshold).template become<Cheap>()}.now(back);
        auto const groups = body.template groups_of<E>(), left = back.template groups_of<E>();
        for (std::size_t e = 0; e < value.size(); ++e) {
          REQUIRE(groups[e] == (value[e] > static_cast<double>(T(threshold)) ? 1 : 0));
          REQUIRE(left[e] == (value[e] < static_cast<double>(T(1.2 * threshold)) ? 1 : 0));
        }
      }
    };
    auto const largest_of = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
    on(Tri3{}, largest_of);
    on(Tet4{}, largest_of);
    on(Tet4{}, AreaRatio{});
    on(Quad4{}, largest_of);
  });
}

}  // namespace pliant::test::bounded_criteria_suite

#pragma once

#include "support/assembly.hpp"
#include "support/formulations.hpp"

namespace pliant::test::stable_step_suite {

/// 2/ω of the highest frequency of the body as it is.
template <class TheBody>
double true_limit(TheBody& body) {
  std::vector<DirectionMask> held(static_cast<std::size_t>(body.nodes()), 0);
  for (auto const& condition : body.state().prescribed->conditions)
    for (Index node : condition.nodes) held[static_cast<std::size_t>(node)] |= condition.directions;
  auto const squares =
      squared_frequencies(body, body.displacements(),
                          [&](std::size_t node, std::size_t k) { return !(held[node] >> k & 1); });
  return 2 / std::sqrt(squares.maxCoeff());
}

TEST_CASE("the stable step is below the true limit and not far", "[solver]") {
  on_each_formulation<MainAlone>([]<class B, class F>(Case<B, F>) {
    using E = typename F::element;
    int const n = F::dim == 2 ? 5 : 3;
    for (unsigned seed = 1; seed <= 2; ++seed) {
      auto const mesh = distorted_mesh<E>(n, seed);
      auto body = body_of<F>(B{}, mesh);
      for (double strain : {0.0, 0.15}) {
        INFO("seed " << seed << ", strain " << strain);
        Random random(seed);
        body.set_displacements(uniform(mesh.nodes, random.tensor<F::dim>(strain)));

        double const bound = stable_step(body), limit = true_limit(body);

        CHECK(bound <= limit);
        CHECK(bound > 0.4 * limit);
      }
    }
  });
}

TEST_CASE("the stable step holds for clamped, stretched and mixed meshes", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    {
      auto mesh = distorted_mesh<Quad4>(5);
      for (auto& x : mesh.nodes) x[0] = x[0] * x[0] * 3 + x[0];  // graded
      auto body = body_of<Rubber>(backend, mesh);
      body.clamp(mesh.boundary("left"));
      body.hold(mesh.boundary("top"), 2);

      double const bound = stable_step(body), limit = true_limit(body);

      CHECK(bound <= limit);
      CHECK(bound > 0.4 * limit);
    }
    {
      auto const mesh = distorted_mesh<Quad4>(5);
      auto body = body_of<Rubber>(backend, mesh);
      std::vector<Index> all(mesh.nodes.size());
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
      body.hold(all, 2);  // moves along x alone

      double const bound = stable_step(body), limit = true_limit(body);

      CHECK(bound <= limit);
      CHECK(bound > 0.4 * limit);
    }
    {
      auto const mesh = mixed_mesh(5);
      Body body{backend,
                mesh,
                soft,
                Group<Rubber>{},
                Group<Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>>{},
                Group<Formulation<Quad4, Gauss<2>, Hooke>>{Hooke<double>{300, 200}}};
      double const bound_before = stable_step(body);
      body.template assign<Formulation<Quad4, Gauss<2>, Hooke>>({0, 3});

      double const bound = stable_step(body), limit = true_limit(body);

      CHECK(bound <= limit);
      CHECK(bound > 0.4 * limit);
      CHECK(bound < 0.2 * bound_before);  // a hundred times as stiff
    }
  });
}

/// Of a body of one cell: sums over elements are of absolute values of each.
template <class F, Backend B>
void check_row_sums(B const& backend) {
  using E = typename F::element;
  auto const mesh = [] {
    if constexpr (E::dim == 2)
      return mesh::rectangle<E>({.size = {1, 0.9}, .cells = {1, 1}});
    else
      return mesh::box<E>({.size = {1, 0.9, 1.2}, .cells = {1, 1, 1}});
  }();
  auto body = body_of<F>(backend, mesh);
  body.set_displacements(Random(3).field<F::dim>(mesh.nodes.size(), 0.03));
  auto const k = assembled_stiffness(body, body.displacements());
  auto const& mass = body.parts().layout.mass_list();
  double largest = 0;
  for (Eigen::Index i = 0; i < k.rows(); ++i)
    largest =
        std::max(largest, k.row(i).cwiseAbs().sum() / mass[static_cast<std::size_t>(i) / E::dim]);

  CHECK(detail::frequency_bounds(body.parts(), detail::Among::all).rows ==
        Approx(largest).epsilon(1e-9));
}

TEST_CASE("sums of rows that bound frequencies are those of the stiffness", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    check_row_sums<Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>>(backend);
    check_row_sums<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend);
    check_row_sums<Formulation<Hex27, Gauss<3>, NeoHookean>>(backend);
  });
}

TEST_CASE("the stable step of large elements is below the true limit and near", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    auto const check = [&]<class F>(F) {
      auto const mesh = distorted_mesh<typename F::element>(2);
      auto body = body_of<F>(backend, mesh);
      for (double strain : {0.0, 0.15}) {
        Random random(5);
        body.set_displacements(uniform(mesh.nodes, random.tensor<3>(strain)));

        double const bound = stable_step(body), limit = true_limit(body);

        CHECK(bound <= limit);
        CHECK(bound > 0.8 * limit);
      }
    };
    check(Formulation<Hex20, Gauss<3>, SaintVenantKirchhoff>{});
    check(Formulation<Hex27, Gauss<3>, NeoHookean>{});
  });
}

TEST_CASE("the stable step is the same in single precision", "[solver]") {
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Hex8>(3);
    using F = Formulation<Hex8, Gauss<2>, NeoHookean>;
    auto body = body_of<F>(backend, mesh);
    auto exact = body_of<F>(Reference<double>{}, mesh);

    CHECK(stable_step(body) == Approx(stable_step(exact)).epsilon(1e-5));
  });
}

}  // namespace pliant::test::stable_step_suite

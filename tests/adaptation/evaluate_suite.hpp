#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::evaluate_suite {

/// x of the first node at rest, as a user might write a criterion.
struct FirstX {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.rest(0, 0);
  }
};
/// |H| in the middle of the cell, times a parameter.
struct GradientNorm {
  double factor;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using T = builtin_scalar<typename State::scalar>;
    return T(factor) * norm(e.gradient());
  }
};

TEST_CASE("criteria are in the user's order", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(5);
    FieldOf<std::size_t{E::dim}> const rest(mesh.nodes.size());

    auto const x = values_at<E>(backend, mesh, rest, FirstX{});

    // A body keeps positions relative to its middle.
    auto const& elements = mesh.template elements<E>();
    double const tolerance = 4 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    REQUIRE(x.size() == elements.size());
    for (std::size_t e = 0; e < x.size(); ++e)
      CHECK(
          x[e] ==
          Approx(mesh.nodes[static_cast<std::size_t>(elements[e][0])][0] - 0.25).margin(tolerance));
  });
}

TEST_CASE("a user's criterion sees the state in the middle of the cell", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(3);
    Tensor<double, E::dim> const h = Random(4).tensor<E::dim>(0.2);
    double const tolerance = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};

    auto const value = values_at<E>(backend, mesh, uniform(mesh.nodes, h), GradientNorm{10});

    for (double v : value) CHECK(v == Approx(10 * norm(h)).epsilon(tolerance));
  });
}

TEST_CASE("a user's criterion rules", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto const mesh = distorted_mesh<Quad4>(6);
    Body body{backend, mesh, soft, Group<Linear>{}, Group<Rubber>{}};
    body.set_displacements(Random(4).field<2>(mesh.nodes.size(), 0.02));
    auto const value = evaluate<Quad4>(body, GradientNorm{1});

    Adaptation{when<Linear>(GradientNorm{10}).above(2).template become<Rubber>()}.now(body);

    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < value.size(); ++e) CHECK(groups[e] == (value[e] > 0.2));
    CHECK(std::ranges::count(groups, 1) > 3);
    CHECK(std::ranges::count(groups, 0) > 3);
  });
}

}  // namespace pliant::test::evaluate_suite

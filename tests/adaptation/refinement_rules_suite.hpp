#pragma once

#include "adaptation/plane_bodies.hpp"

namespace pliant::test::refinement_rules_suite {

/// The same for every element.
struct Constant {
  double value;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    return typename State::scalar(static_cast<builtin_scalar<typename State::scalar>>(value));
  }
};

/// The areas of a body's elements, from its mesh.
template <Element E, class TheBody>
std::vector<double> areas(TheBody const& body) {
  std::vector<double> all;
  for (auto const& nodes : body.mesh().template elements<E>())
    all.push_back(volume<E, Gauss<2>>(nodal(body.mesh(), nodes)));
  return all;
}

TEST_CASE("a rule refines the elements of its formulation that it marks", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    auto body = plane_body(backend, mesh), twin = plane_body(backend, mesh);
    Random random(2);
    auto const u = random.field<2>(mesh.nodes.size(), 0.01);
    auto const linear = random_marks(body, random, 2);
    for (auto* each : {&body, &twin}) {
      each->set_displacements(u);
      put(*each, linear, Put::linear);
    }
    auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});
    auto const groups = body.template groups_of<Quad4>();
    Marks expected(1);
    for (std::size_t e = 0; e < value.size(); ++e)
      if (groups[e] == 1 && value[e] > 0.06) expected[0].push_back(static_cast<Index>(e));
    REQUIRE(expected[0].size() > 3);

    Adaptation{when<QuadLinear>(EdgeLengthRatio{}).above(0.06).refine()}.now(body);
    refine(twin, expected);

    CHECK(body.mesh().tables == twin.mesh().tables);
    CHECK(body.mesh().nodes == twin.mesh().nodes);
    CHECK(ledger(body)[0].elements == static_cast<double>(expected[0].size()));
  });
}

template <Element E>
using Rubber = std::conditional_t<std::same_as<E, Tri3>, TriRubber, QuadRubber>;

template <Element... Es>
auto refine_all(Mesh<Es...> const&, RefineOptions options) {
  return Adaptation{when<Rubber<Es>>(Constant{1}).above(0.5).refine(options)...};
}

TEST_CASE("elements are refined as often as their rule says", "[adaptation]") {
  on_plane_meshes<MainAlone>(3, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    auto const all = element_count(body);
    auto adapt = refine_all(mesh, {.max_level = 2});
    for (std::size_t k : {4u, 16u, 16u}) {
      adapt.now(body);
      CHECK(element_count(body) == k * all);
    }
  });
}

TEST_CASE("each rule has its own greatest level", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // Sixteen cells in a row: linear ones on the left, with their level 1, neo-Hookean ones on the
    // right, with their level 3.
    auto body = plane_body(backend, mesh::rectangle({.size = {16, 1}, .cells = {16, 1}}));
    put(body, {{0, 1, 2, 3, 4, 5, 6, 7}}, Put::linear);
    Adaptation adapt{when<QuadRubber>(Constant{1}).above(0.5).refine({.max_level = 3}),
                     when<QuadLinear>(Constant{1}).above(0.5).refine({.max_level = 1})};

    for (int k = 0; k < 5; ++k) adapt.now(body);

    auto const size = areas<Quad4>(body);
    auto const groups = body.template groups_of<Quad4>();
    auto const& elements = body.mesh().template elements<Quad4>();
    for (std::size_t e = 0; e < size.size(); ++e) {
      double const x = body.mesh().nodes[static_cast<std::size_t>(elements[e][0])][0];
      if (groups[e] == 0) CHECK(size[e] == Approx(1.0 / 64));
      if (groups[e] == 1 && x < 6) CHECK(size[e] == Approx(1.0 / 4));
    }
    CHECK(std::ranges::count(groups, 0) == 8 * 64);
  });
}

TEST_CASE("a rule that refines keeps its budget, closure aside", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(6);
    auto body = plane_body(backend, mesh);
    body.set_displacements(Random(2).field<2>(mesh.nodes.size(), 0.01));

    Adaptation{when<TriRubber>(ForceIntensity<>{}).bulk(0.9).budget(5).refine()}.now(body);

    CHECK(element_count(body) == mesh.elements<Tri3>().size() + 3 * 5);
  });
}

TEST_CASE("rules switch before they refine, and children have the new group", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    auto body = plane_body(backend, mesh);
    auto const all = element_count(body);

    Adaptation{when<QuadLinear>(Constant{1}).above(0.5).refine(),
               when<QuadRubber>(Constant{1}).above(0.5).template become<QuadLinear>()}
        .now(body);

    CHECK(element_count(body) == 4 * all);
    CHECK(body.template groups_of<Quad4>() == std::vector<Tag>(4 * all, 1));
    CHECK(ledger(body).size() == 2);
  });
}

TEST_CASE("refinement that would exceed the capacity leaves the body to go on", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    auto body = plane_body(backend, mesh);
    body.set_gravity({0, -1});
    set_mesh_limits(body, {.elements = 30});
    Adaptation adapt{when<QuadRubber>(Constant{1}).above(0.5).refine()};
    CentralDifference step;
    step(body, 3);

    CHECK_THROWS_AS(adapt.now(body), Error);

    CHECK(element_count(body) == 12);
    step(body, 3);
    CHECK(body.steps() == 6);
    for (auto const& v : body.velocities()) CHECK(v[1] == Approx(-body.time()).epsilon(1e-12));
  });
}

TEST_CASE("rules that would be ignored in part are refused", "[adaptation]") {
  auto const rule = when<QuadRubber>(EdgeLengthRatio{});
  CHECK_THROWS_AS(rule.above(1).stay(3).refine(), Error);
  CHECK_THROWS_AS(rule.below(1).floor(0.5), Error);
}

}  // namespace pliant::test::refinement_rules_suite

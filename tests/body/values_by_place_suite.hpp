#pragma once

#include <pliant/adaptation/estimator/law_discrepancy.hpp>
#include <pliant/adaptation/force_costs.hpp>
#include <pliant/adaptation/refinement.hpp>

#include "support/fields.hpp"
#include "support/formulations.hpp"

// Values that laws read per element, by the place of the element.
namespace pliant::test::values_by_place_suite {

using Artery = Formulation<Quad4, Gauss<2>, HolzapfelGasserOgden>;
using Graded = Formulation<Quad4, Gauss<2>, PerElement<NeoHookean>::law>;
using Graded9 = Formulation<Quad9, Gauss<3>, PerElement<NeoHookean>::law>;
inline constexpr HolzapfelGasserOgden<double> wall{
    .mu = 20, .k1 = 50, .k2 = 0.5, .dispersion = 0.05, .bulk = 80};

/// Fibres around the origin, one family a little askew.
inline std::array<double, 6> around(Point<2> const& x) {
  double const r = std::hypot(x[0], x[1]);
  return {-x[1] / r, x[0] / r, 0, -x[1] / r, x[0] / r, 0.3};
}
inline std::array<double, 2> stiffer_upwards(Point<2> const& x) { return {2 + x[1], 3 + 2 * x[0]}; }

inline auto quarter() {
  auto mesh = mesh::rectangle({.size = {1, 1}, .cells = {3, 4}});
  for (auto& x : mesh.nodes) {
    double const r = 1 + 0.3 * x[0], angle = 1.5 * x[1];
    x = {r * std::cos(angle), r * std::sin(angle)};
  }
  return mesh;
}
template <class Nodes>
FieldOf<2> stretched(Nodes const& nodes) {
  FieldOf<2> u;
  for (auto const& x : nodes) u.push_back({0.1 * x[0] + 0.03 * x[1] * x[1], 0.2 * x[1] * x[0]});
  return u;
}

TEST_CASE("values by place are those of each element's mean of nodes", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = quarter();
    std::vector<std::array<double, 6>> listed;
    for (auto const& element : mesh.template elements<Quad4>())
      listed.push_back(around(mean_of_nodes(mesh, element)));
    Body by_place{backend, mesh, soft, Group<Artery>{wall, {}, around}};
    Body by_list{backend, mesh, soft, Group<Artery>{wall, listed}};

    by_place.set_displacements(stretched(mesh.nodes));
    by_list.set_displacements(stretched(mesh.nodes));

    CHECK(largest(by_list.forces()) > 1);
    CHECK(difference(by_place.forces(), by_list.forces()) <= 1e-12 * largest(by_list.forces()));
  });
}

TEST_CASE("new elements have the values of their own place", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = quarter();
    auto const forces = [](auto& body) {
      body.set_displacements(stretched(body.mesh().nodes));
      return body.forces();
    };
    Body body{backend, mesh, soft, Group<Artery>{wall, {}, around}};
    auto const before = forces(body);
    refine(body, {{1, 5}});
    Body fresh{backend, body.mesh(), soft, Group<Artery>{wall, {}, around}};
    // What children have without values_at.
    Body heir{backend, mesh, soft,
              Group<Artery>{wall, [&] {
                              std::vector<std::array<double, 6>> listed;
                              for (auto const& element : mesh.template elements<Quad4>())
                                listed.push_back(around(mean_of_nodes(mesh, element)));
                              return listed;
                            }()}};
    refine(heir, {{1, 5}});

    double const size = largest(forces(fresh));
    CHECK(difference(forces(body), forces(fresh)) <= 1e-12 * size);
    CHECK(difference(forces(heir), forces(fresh)) > 1e-3 * size);

    std::vector<Index> all(body.mesh().template elements<Quad4>().size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
    coarsen(body, {all});
    CHECK(difference(forces(body), before) <= 1e-12 * size);
  });
}

TEST_CASE("elements of another degree have the values of their place", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Mesh<Quad4, Quad9> mesh{quarter().nodes, {}};
    mesh.elements<Quad4>() = quarter().template elements<Quad4>();
    auto const make = [&](auto const& of) {
      return Body{backend, of, soft, Group<Graded>{.values_at = stiffer_upwards},
                  Group<Graded9>{.values_at = stiffer_upwards}};
    };
    auto body = make(mesh);
    raise(body, {{2, 7}, {}});
    auto fresh = make(body.mesh());

    REQUIRE(body.mesh().template elements<Quad9>().size() == 2);
    body.set_displacements(stretched(body.mesh().nodes));
    fresh.set_displacements(stretched(fresh.mesh().nodes));
    CHECK(difference(body.forces(), fresh.forces()) <= 1e-12 * largest(fresh.forces()));
  });
}

TEST_CASE("what asks a group for its values finds those by place", "[body]") {
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  Reference<double> const backend;
  auto const mesh = quarter();
  std::vector<std::array<double, 2>> listed;
  for (auto const& element : mesh.template elements<Quad4>())
    listed.push_back(stiffer_upwards(mean_of_nodes(mesh, element)));
  auto const body_of_group = [&](Group<Graded> const& group) {
    Body body{backend, mesh, soft, Group<Graded>{group}, Group<Rubber>{}};
    body.set_displacements(stretched(mesh.nodes));
    return body;
  };
  auto by_place = body_of_group({.values_at = stiffer_upwards}),
       by_list = body_of_group({.values = listed});

  double const found = estimate(by_place, LawDiscrepancy<Rubber>{});

  CHECK(found > 0);
  CHECK(found == Approx(estimate(by_list, LawDiscrepancy<Rubber>{})).epsilon(1e-12));
  auto const costs = [](auto const& body) {
    return detail::counted_costs(body.parts(), detail::TypeList<Rubber, Graded>{});
  };
  CHECK(costs(by_place) == costs(by_list));
}

TEST_CASE("values by place that cannot be are refused, with the body as it was", "[body]") {
  Reference<double> const backend;
  auto const mesh = quarter();
  CHECK_THROWS_WITH((Body{backend, mesh, soft, Group<Artery>{wall, {around({1, 0})}, around}}),
                    says("values and values_at; give one of them"));
  auto const nan = [](Point<2> const&) { return std::array<double, 2>{2, NAN}; };
  CHECK_THROWS_WITH((Body{backend, mesh, soft, Group<Graded>{.values_at = nan}}),
                    says("value 1 of an element Quad4 around ("));
  bool fails = false;
  auto const later = [&](Point<2> const& x) {
    return std::array<double, 2>{2, fails ? INFINITY : 3 + x[0]};
  };
  Body body{backend, mesh, soft, Group<Graded>{.values_at = later}};
  body.set_displacements(stretched(mesh.nodes));
  auto const before = body.forces();
  fails = true;

  CHECK_THROWS_WITH(refine(body, {{3}}), says("value 1 of an element Quad4 around ("));

  CHECK(body.mesh().nodes.size() == mesh.nodes.size());
  CHECK(difference(body.forces(), before) == 0);
  fails = false;
  CHECK_NOTHROW(refine(body, {{3}}));
}

}  // namespace pliant::test::values_by_place_suite

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "adaptation/two_bodies.hpp"
#include "topology/random_changes.hpp"

// Bounds of frequencies that changes of the mesh raise, beside those of all elements.
namespace pliant::test::raised_bounds_suite {

/// By the place of a node at rest: the largest row sum over mass of its free directions, 1/s².
template <class TheBody>
std::map<Point<TheBody::dim>, double> rates(TheBody& body) {
  constexpr int dim = TheBody::dim;
  auto& parts = body.parts();
  (void)detail::frequency_bounds(parts, detail::Among::all);
  using T = typename TheBody::scalar;
  auto const rows = download<T>(parts.row_sums), mass = download<T>(parts.layout.mass);
  auto const held = download<DirectionMask>(parts.layout.held);
  std::map<Point<dim>, double> found;
  for (Index node = 0; node < body.nodes(); ++node) {
    auto const row = static_cast<std::size_t>(parts.layout.internal_of(node));
    double& own = found[body.mesh().nodes[static_cast<std::size_t>(node)]];
    for (std::size_t k = 0; mass[row] > 0 && k < dim; ++k)
      if (!(held[row] >> k & 1))
        own = std::max<double>(own, rows[node_stride * row + k] / mass[row]);
  }
  return found;
}

/// What has been looked at in some changes.
struct Seen {
  int raised = 0, below_the_largest = 0, where_nodes_went = 0;
};

/// Checks what a change makes of bounds that are as good as none.
template <class TheBody, class Change>
void check_change(TheBody& body, Seen& seen, Change const& change) {
  auto& parts = body.parts();
  CentralDifference step;
  step(body, 1);
  auto& own = parts.state.integrator;
  REQUIRE(own.next_refresh > parts.state.steps);
  parts.state.bounds = {1, 1e-30};
  auto const before = rates(body);
  change();
  if (!own.bounds_raised) return;
  auto const after = rates(body);
  double largest = 0, largest_changed = 0;
  for (auto const& [place, rate] : after) {
    largest = std::max(largest, rate);
    auto const old = before.find(place);
    if (old == before.end() || std::abs(old->second - rate) > 1e-9 * rate)
      largest_changed = std::max(largest_changed, rate);
  }
  double const raised = parts.state.bounds.rows / parts.layout.interpolation.magnitude();
  CHECK(raised >= (1 - 1e-12) * largest_changed);
  CHECK(raised <= (1 + 1e-12) * largest);
  CHECK(parts.state.bounds.elements == std::numeric_limits<double>::infinity());
  ++seen.raised;
  seen.below_the_largest += raised < 0.9 * largest;
  seen.where_nodes_went += own.next_refresh == parts.state.steps + 128;
}

template <class F, class B>
void check_refinements(B const& backend, Index cells, bool on_host) {
  auto body = two_bodies::body_of<F>(backend, on_host, cells);
  refine(body, {{0}});
  Random random(5);
  Seen seen;
  for (int round = 0; round < 6; ++round) {
    check_change(body, seen, [&] { refine(body, {two_bodies::some(body, 40, random)}, 3); });
    check_change(body, seen,
                 [&] { coarsen(body, {two_bodies::some(body, 1 + round % 2, random)}); });
  }
  CHECK(two_bodies::is_on_backend(body) != on_host);
  CHECK(seen.raised >= 9);
  CHECK(seen.where_nodes_went >= 3);
}

TEST_CASE("a change of the mesh raises bounds of frequencies by those of what it changes",
          "[solver]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    for (bool on_host : {false, true}) {
      INFO("on the host: " << on_host);
      check_refinements<Formulation<Tri3, Gauss<1>, NeoHookean>>(backend, 6, on_host);
      check_refinements<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, 3, on_host);
    }
    check_refinements<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend, 3, false);
  });
}

TEST_CASE("bounds hold whatever elements a change makes of others", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = ChangingPlane::body(backend);
    Random random(7);
    body.set_displacements(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.005));
    Seen seen;
    for (int round = 0; round < 40; ++round)
      check_change(body, seen, [&] { change<ChangingPlane>(body, random); });
    CHECK(seen.raised > 10);
  });
}

/// A strip of quads of which those at the right are a tenth as long.
inline auto graded_strip() {
  auto mesh = mesh::rectangle<Quad4>({.size = {4, 1}, .cells = {12, 4}});
  for (auto& x : mesh.nodes)
    if (x[0] > 2) x[0] = 2 + 0.1 * (x[0] - 2);
  return mesh;
}
using Quads = Formulation<Quad4, Gauss<2>, NeoHookean>;

TEST_CASE("rows of elements that stay far away have no part in raised bounds", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    Body body{backend, graded_strip(), soft, Group<Quads>{}};
    Seen seen;
    check_change(body, seen, [&] { refine(body, {{0}}); });
    CHECK(seen.below_the_largest == 1);
  });
}

TEST_CASE("a step behind a change is chosen by raised bounds", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    Body body{backend, mesh::rectangle<Quad4>({.size = {2, 1}, .cells = {8, 4}}), soft,
              Group<Quads>{}};
    CentralDifference step;
    step(body, 20);
    auto const& state = body.state();
    auto const& own = state.integrator;
    double const first = own.step;
    auto const next = own.next_refresh;
    auto const chosen = [&] { return 0.9 * 2 / std::sqrt(state.bounds.rows); };

    refine(body, {{0, 5}});
    CHECK(own.bounds_raised);
    CHECK(own.next_refresh == next);
    std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
    body.save(saved);
    step(body, 1);
    CHECK(!own.bounds_raised);
    CHECK(own.step == Approx(chosen()).epsilon(1e-14));
    CHECK(own.step < 0.6 * first);
    CHECK(own.step <= 0.9 * (1 + 1e-12) * stable_step(body));
    CHECK(own.step > 0.8 * stable_step(body));
    double const after = own.step;

    refine(body, {{10}});  // no smaller elements than there were
    step(body, 1);
    CHECK(own.step == after);

    std::vector<Index> all(
        static_cast<std::size_t>(std::get<0>(body.parts().layout.tables).count()));
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
    coarsen(body, {all});
    step(body, 128);
    CHECK(own.step == after);
    step(body, 1);
    CHECK(own.step == Approx(first).epsilon(1e-12));
    CHECK(std::isfinite(state.bounds.elements));  // since rows fell by more than half

    body.load(saved);
    CentralDifference other;
    other(body, 1);
    CHECK(own.step == after);  // without a look at all elements
    CHECK(own.next_refresh == next);
  });
}

TEST_CASE("eigenvalues of elements are looked at again in time", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    auto mesh = mesh::rectangle<Quad4>({.size = {2, 1}, .cells = {8, 4}});
    mesh.nodes[20][0] += 0.7 * 0.25;  // a bad element, of which rows make less
    Body body{backend, mesh, soft, Group<Quads>{}};
    CentralDifference step({.refresh_interval = 100});
    auto const& bounds = body.state().bounds;
    auto const look = [&](int steps) {
      step(body, steps);
      body.set_velocities(body.velocities());  // by hand: asks for a step
      step(body, 1);
      return std::isfinite(bounds.elements);
    };
    step(body, 1);
    CHECK(bounds.elements > 1.3 * bounds.rows);
    double const rows = bounds.rows;
    CHECK(!look(8));
    CHECK(bounds.rows == rows);
    CHECK(!look(80));
    CHECK(look(10));
    CHECK(bounds.rows == rows);
  });
}

TEST_CASE("all elements are looked at where bounds do not tell", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    auto const mesh = mesh::rectangle<Quad4>({.size = {2, 1}, .cells = {8, 4}});
    auto const is_raised = [](auto& body, auto&& step) {
      step(body, 20);
      refine(body, {{0}});
      auto const& state = body.state();
      bool const raised = state.integrator.bounds_raised;
      CHECK((state.integrator.next_refresh > state.steps) == raised);
      return raised;
    };
    Body body{backend, mesh, soft, Group<Quads>{}};
    CHECK(is_raised(body, CentralDifference{}));
    Body with_own_step{backend, mesh, soft, Group<Quads>{}};
    CHECK(!is_raised(with_own_step, CentralDifference({.step = 0.1 * stable_step(body)})));
    Body by_elements{backend, mesh::rectangle<Tri6>({.size = {2, 1}, .cells = {6, 3}}), soft,
                     Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{}};
    CHECK(!is_raised(by_elements, CentralDifference{}));  // whose rows give half the step
    Body in_levels{backend, mesh, soft, Group<Quads>{}};
    LocalSteps local;
    local(in_levels, 20);
    CHECK(!is_raised(in_levels, local));
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
    Body viscous{backend, mesh, soft, Group<Viscous>{Viscous::law<double>{{3, 2}, {0.5}, {0.1}}}};
    CHECK(!is_raised(viscous, CentralDifference{}));
    Body changed{backend, mesh, soft, Group<Quads>{}};
    CentralDifference step;
    step(changed, 20);
    changed.set_displacements(FieldOf<2>(mesh.nodes.size()));
    refine(changed, {{0}});
    CHECK(changed.state().integrator.next_refresh == changed.steps());
  });
}

}  // namespace pliant::test::raised_bounds_suite

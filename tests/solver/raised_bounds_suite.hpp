#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <sstream>
#include <type_traits>
#include <vector>

#include "adaptation/two_bodies.hpp"
#include "support/small_patches.hpp"
#include "topology/random_changes.hpp"

// Bounds of frequencies that changes of the mesh raise, beside those of all elements.
namespace pliant::test::raised_bounds_suite {

/// What a change of a mesh marked, and made of the sums of marked rows; by the row of a node.
template <class T>
struct Marked {
  static inline std::vector<std::uint8_t> marks;
  static inline std::vector<T> sums;
};
/// As an integrator's: looks at the same, and leaves it there.
template <class Parts>
void look_at_marked(Parts const&, Parts& next, ChangedRows<typename Parts::backend_type>& changed) {
  using T = typename Parts::T;
  detail::spread_marks(next, changed);
  Marked<T>::marks = download<std::uint8_t>(changed.marks);
  Marked<T>::sums = download<T>(detail::sums_of_marked_rows(next, changed.marks.data()));
}

/// By the place of a node at rest that has mass: sums of its row.
template <class TheBody>
auto row_sums(TheBody& body) {
  constexpr std::size_t dim = TheBody::dim;
  auto& parts = body.parts();
  (void)detail::frequency_bounds(parts, detail::Among::all);
  using T = typename TheBody::scalar;
  auto const rows = download<T>(parts.row_sums), mass = download<T>(parts.layout.mass);
  std::map<Point<TheBody::dim>, std::array<T, dim>> found;
  for (Index node = 0; node < body.nodes(); ++node) {
    auto const row = static_cast<std::size_t>(parts.layout.internal_of(node));
    auto& own = found[body.mesh().nodes[static_cast<std::size_t>(node)]];
    for (std::size_t k = 0; k < dim; ++k) own[k] = mass[row] > 0 ? rows[node_stride * row + k] : 0;
  }
  return found;
}

/// What was seen in some changes.
struct Seen {
  int changes = 0, marked = 0, others = 0;
};

/// Checks that rows which a change does not mark are as they were, and that those marked have their sums.
template <class TheBody, class Change>
void check_change(TheBody& body, Seen& seen, Change const& change) {
  using T = typename TheBody::scalar;
  auto& parts = body.parts();
  CentralDifference step;
  step(body, 1);
  REQUIRE(parts.state.integrator.next_refresh > parts.state.steps);
  parts.state.bounds = {1, 1};  // of whatever kind elements are
  parts.raise_bounds = look_at_marked<std::remove_cvref_t<decltype(parts)>>;
  auto const before = row_sums(body);
  Marked<T>::marks.clear();
  change();
  if (Marked<T>::marks.empty()) return;  // nothing changed
  int wrong_sums = 0, wrong_marks = 0;
  for (auto const& row_of_node : row_sums(body)) {
    auto const& place = row_of_node.first;
    auto const& sums = row_of_node.second;
    auto const node = std::ranges::find(body.mesh().nodes, place) - body.mesh().nodes.begin();
    auto const row = static_cast<std::size_t>(parts.layout.internal_of(static_cast<Index>(node)));
    auto const old = before.find(place);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      auto const differs = [&](T from) { return !(std::abs(from - sums[k]) <= 1e-10 * sums[k]); };
      if (sums[k] == 0) continue;  // it hangs
      if (Marked<T>::marks[row] != 0)
        wrong_sums += differs(Marked<T>::sums[node_stride * row + k]);
      else
        wrong_marks += old == before.end() || differs(old->second[k]);
    }
    ++(Marked<T>::marks[row] != 0 ? seen.marked : seen.others);
  }
  CHECK(wrong_sums == 0);
  CHECK(wrong_marks == 0);
  ++seen.changes;
}

template <class F, class B>
void check_refinements(B const& backend, Index cells, bool on_host) {
  auto body = two_bodies::body_of<F>(backend, on_host, cells);
  Random random(5);
  // So that nodes which begin to hang are displaced by more than rounding.
  body.set_displacements(random.field<F::dim>(static_cast<std::size_t>(body.nodes()), 0.005));
  refine(body, {{0}});
  Seen seen;
  for (int round = 0; round < 6; ++round) {
    check_change(body, seen, [&] { refine(body, {two_bodies::some(body, 60, random)}, 3); });
    check_change(body, seen, [&] {
      coarsen(body, {two_bodies::some(body, static_cast<std::size_t>(1 + round % 2), random)});
    });
  }
  CHECK(two_bodies::is_on_backend(body) != on_host);
  CHECK(seen.changes >= 9);
  CHECK(seen.marked > 50);
  CHECK(seen.others > 50);
}

TEST_CASE("the rows that a change of the mesh changes are found, and summed", "[solver]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    for (bool on_host : {false, true}) {
      INFO("on the host: " << on_host);
      check_refinements<Formulation<Tri3, Gauss<1>, NeoHookean>>(backend, 10, on_host);
      check_refinements<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, 4, on_host);
    }
    check_refinements<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend, 4, false);
  });
}

template <class B>
void check_many_changes(B const& backend) {
  auto body = ChangingPlane::body(backend);
  Random random(7);
  body.set_displacements(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.005));
  Seen seen;
  for (int round = 0; round < 40; ++round)
    check_change(body, seen, [&] { change<ChangingPlane>(body, random); });
  CHECK(seen.changes > 20);
}

TEST_CASE("changed rows are found whatever elements a change makes of others", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) { check_many_changes(backend); });
}

TEST_CASE("rows are summed from patches that have a part in them", "[solver]") {
  check_many_changes(SmallPatches<double, 4>{});
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
    CentralDifference step;
    step(body, 1);
    auto& bounds = body.parts().state.bounds;
    double const largest = bounds.rows;
    for (double before : {1.0, 2 * largest}) {
      bounds = {before, before};
      refine(body, {{0}});
      CHECK(bounds.elements == std::numeric_limits<double>::infinity());
      if (before == 1)
        CHECK((bounds.rows > 2 && bounds.rows < 0.9 * largest));
      else
        CHECK(bounds.rows == before);
    }
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
    Body by_elements{backend, mesh::rectangle<Tri3>({.size = {2, 1}, .cells = {6, 3}}), soft,
                     Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{}};
    CHECK(!is_raised(by_elements, CentralDifference{}));  // whose rows give a shorter step by 11 %
    Body quadratic{backend, mesh::rectangle<Tri6>({.size = {2, 1}, .cells = {6, 3}}), soft,
                   Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{}};
    CHECK(!is_raised(quadratic, [](auto& own, int steps) {  // whose hanging nodes weigh more
      CentralDifference{}(own, steps);
      own.parts().state.bounds = {1, 1};
    }));
    Body moving{backend, mesh, soft, Group<Quads>{}};  // of which the change changes many rows
    CHECK(!is_raised(moving, [&](auto& own, int) {
      CentralDifference{}(own, 1);
      auto u = mesh.nodes;  // twice as large, behind the integrator's back
      own.parts().state.u.upload(own.parts().layout.padded(u));
      own.parts().state.integrator.next_watch = own.steps();
    }));
    Body in_levels{backend, mesh, soft, Group<Quads>{}};
    CentralDifference{}(in_levels, 1);  // which leaves bounds
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

TEST_CASE("a step behind a change looks at distortion when it is time to", "[solver]") {
  on_each_backend<MainAlone>([](auto const& backend) {
    auto const mesh = mesh::rectangle<Quad4>({.size = {2, 1}, .cells = {24, 12}});
    for (int steps_to_watch : {0, 3}) {
      Body body{backend, mesh, soft, Group<Quads>{}};
      CentralDifference step({.refresh_interval = 1000, .watch_interval = 1000});
      auto velocities = mesh.nodes;  // twice as long within 20 steps, if nothing held it
      double const rate = 1 / (20 * 0.9 * stable_step(body));
      for (auto& v : velocities)
        for (double& x : v) x *= rate;
      body.set_velocities(velocities);
      step(body, 20);
      auto& own = body.parts().state.integrator;
      CHECK(own.distortion < 0.01);
      own.next_watch = body.steps() + steps_to_watch;
      refine(body, {{0}});
      CHECK(own.bounds_raised);
      CHECK(own.next_watch == body.steps() + steps_to_watch);
      step(body, steps_to_watch);
      CHECK(own.distortion < 0.01);
      step(body, 1);
      CHECK(own.distortion > 0.15);
    }
  });
}

}  // namespace pliant::test::raised_bounds_suite

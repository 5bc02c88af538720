#include <algorithm>
#include <map>
#include <string>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>

#include "support/formulations.hpp"

// Tables of a mesh that changes: patches that stay keep what was planned for them.
namespace pliant::test::changed_fans_test {

/// All that loops over a table use, by what it is.
using Description = std::map<std::string, std::vector<Index>>;

template <class Elements>
Description described(Elements const& elements, int groups) {
  Description is;
  auto const add = [&](char const* what, auto const&... values) {
    (is[what].push_back(static_cast<Index>(values)), ...);
  };
  auto const& rows = elements.rows();
  auto const flat = elements.rows_of_nodes();
  for (Index const first : elements.patch_bounds()) add("patches", first);
  for (Index p = 0; p < elements.patch_count(); ++p) {
    auto const& plan = elements.plan_of(p);
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
      add("nodes of patches", plan.nodes[k]);
      add("targets", rows.targets(p)[k]);
    }
    for (auto const place : plan.places) add("places", place);
    for (auto const e : plan.fans.elements) add("fans: elements", e);
    for (auto const size : plan.fans.sizes) add("fans: sizes", size);
    for (int g = 0; g < groups; ++g) {
      for (auto const e : elements.members(p, g)) add("members", p, g, e);
      if (elements.has_fans())
        for (auto const& run : elements.runs(p, g))
          add("runs", p, g, run.ends, run.ring, run.elements, run.size);
    }
    detail::PatchTargets<Elements::nodes_per_element> const targets(elements, p);
    for (Index e = elements.patch_bounds()[static_cast<std::size_t>(p)];
         e < elements.patch_bounds()[static_cast<std::size_t>(p) + 1]; ++e)
      for (int a = 0; a < Elements::nodes_per_element; ++a) {
        add("nodes", elements.nodes(e)[a]);
        add("nodes by the patch", elements.nodes(p, e)[a]);
        add("nodes one after another", flat[e][a]);
        add("targets of elements", targets.of(e)[a]);
      }
    auto const [first, last] = rows.scratch_of(p);
    add("scratch rows", first, last);
    for (Index row = first; row < last; ++row) {
      add("patches of scratch rows", rows.patch_of_row(row));
      add("nodes of scratch rows", rows.folded_of_row(row).node);
    }
  }
  for (Index k = 0; k < rows.folded_count(); ++k) {
    add("folds", rows.folded(k).node);
    for (Index const row : rows.folded(k).rows) add("folds", row);
  }
  return is;
}

/// What a table promises by itself: each element once, its nodes in its fan, each node's rows folded into it.
template <class Elements>
void check(Elements const& elements, int groups) {
  constexpr int nodes = Elements::nodes_per_element;
  auto const count = static_cast<std::size_t>(elements.count());
  std::vector<int> in_groups(count), in_fans(count);
  bool right = true;
  for (Index p = 0; p < elements.patch_count(); ++p) {
    Index const first = elements.patch_bounds()[static_cast<std::size_t>(p)];
    for (int g = 0; g < groups; ++g)
      for (auto const e : elements.members(p, g)) ++in_groups[static_cast<std::size_t>(first + e)];
    if (elements.has_fans())
      elements.fans(p).for_each_element([&](Index e, std::array<std::uint16_t, 4> const& corners) {
        ++in_fans[static_cast<std::size_t>(e)];
        std::array<Index, 4> own, known;
        for (std::size_t a = 0; a < 4; ++a) own[a] = elements.fans(p).nodes[corners[a]];
        std::copy_n(elements.nodes(e), 4, known.begin());
        std::ranges::sort(own);
        std::ranges::sort(known);
        right = right && own == known;
      });
    detail::PatchTargets<nodes> const targets(elements, p);
    auto const [begin, end] = elements.rows().scratch_of(p);
    for (Index e = first; e < elements.patch_bounds()[static_cast<std::size_t>(p) + 1]; ++e)
      for (int a = 0; a < nodes; ++a) {
        Index const row = targets.of(e)[a], node = elements.nodes(e)[a];
        right = right && (row == node || (begin <= row && row < end &&
                                          elements.rows().folded_of_row(row).node == node));
      }
  }
  CHECK(right);
  CHECK(in_groups == std::vector<int>(count, 1));
  if (elements.has_fans()) CHECK(in_fans == std::vector<int>(count, 1));
}

/// Gives a second group the first element of each patch, such that many patches have the same tags, or some of a part of the
/// body.
template <Element E, class First, class Second, class Body>
void assign(Body& body, int i) {
  auto const& table = body.parts().layout.template table<E>();
  std::vector<Index> others, some;
  for (Index p = 0; p < table.elements.patch_count(); ++p) {
    Index const first = table.elements.patch_bounds()[static_cast<std::size_t>(p)],
                last = table.elements.patch_bounds()[static_cast<std::size_t>(p) + 1];
    for (Index e = first; e < last; ++e) {
      bool const is_some = i % 2 == 0 ? e == first : p % 3 < 2 && e % (5 + i) < 2;
      (is_some ? some : others).push_back(table.user_element(e));
    }
  }
  body.template assign<First>(others);
  body.template assign<Second>(some);
}

/// Refines and coarsens a body here and there, and compares its table each time with one made anew.
template <class E, class Body, class Assign>
void compare(Body& body, int changes, Assign const& assign_groups) {
  using Layout = typename Body::layout_type;
  Random random(11);
  Index fewest = 100;
  std::size_t kept = 0, made = 0, renumbered = 0;
  for (int i = 0; i < changes; ++i) {
    INFO("change " << i);
    assign_groups(i);
    auto const count = body.mesh().template elements<E>().size();
    auto const plans_before = [&] {
      std::vector<detail::PatchPlan const*> plans;
      auto const& elements = body.parts().layout.template table<E>().elements;
      for (Index p = 0; p < elements.patch_count(); ++p) plans.push_back(&elements.plan_of(p));
      return plans;
    }();
    std::vector<Index> marked;
    auto const levels = refinement_levels<E>(body);
    bool const back = i % 3 == 2;
    auto const first = random.below(static_cast<unsigned>(count));
    for (std::size_t e = 0; e < count; ++e)
      if (back ? levels[e] > 0 && random.below(8) != 0 : e - first < 3)
        marked.push_back(static_cast<Index>(e));
    auto const& table = body.parts().layout.template table<E>();
    for (Index e = 0; i % 6 == 1 && e < 100; ++e)  // of the first chapter, which gets another patch
      marked.push_back(table.user_element(e));
    if (back)
      coarsen(body, {marked});
    else
      refine(body, {marked});

    auto const& parts = body.parts();
    Layout anew(parts.backend, *parts.state.topology, parts.material, parts.groups, &parts.layout,
                parts.layout.node_rows());
    auto const& elements = parts.layout.template table<E>().elements;
    auto& fresh = anew.template table<E>().elements;
    constexpr int groups = Layout::template Table<E>::groups;
    if constexpr (groups > 1) {
      body.parts().for_each_type([&](auto const&, auto const& of_type) {
        fresh.tags().upload({of_type.tags.data(), of_type.tags.size()});
      });
      fresh.regroup();
    }
    auto const is = described(elements, groups), has_to_be = described(fresh, groups);
    for (auto const& [what, values] : has_to_be) {
      INFO(what);
      CHECK((is.contains(what) && is.at(what) == values));
    }
    CHECK(is.size() == has_to_be.size());
    check(elements, groups);
    for (Index p = 0; p < elements.patch_count(); ++p) {
      auto const before = std::ranges::find(plans_before, &elements.plan_of(p));
      ++(before != plans_before.end() ? kept : made);
      if (before != plans_before.end() && before - plans_before.begin() != p) ++renumbered;
    }
    fewest = std::min(fewest, elements.patch_count());
  }
  CHECK(fewest >= 8);  // which two threads share
  CHECK(made > 0);
  CHECK(kept > 10);
  CHECK(renumbered > 0);
}

template <Element E, class... Fs>
void compare_on(int threads, int cells, int changes) {
  INFO(threads << " threads");
  HostThreads const host(threads);  // of so small a mesh as well
  Body body{OpenMP<double>{{.threads = threads}}, distorted_mesh<E>(cells), soft, Group<Fs>{}...};
  compare<E>(body, changes, [&](int i) {
    if constexpr (sizeof...(Fs) > 1) assign<E, Fs...>(body, i);
  });
}

TEST_CASE("tables of a mesh that changed are those made anew", "[openmp]") {
  using Kirchhoff = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  using Rubber = Formulation<Tet4, Gauss<1>, NeoHookean>;
  for (int threads : {1, 3}) compare_on<Tet4, Kirchhoff, Rubber>(threads, 15, 9);
}
TEST_CASE("tables without fans of a mesh that changed are those made anew", "[openmp]") {
  using Bricks = Formulation<Hex8, Gauss<2>, NeoHookean>;
  for (int threads : {1, 3}) compare_on<Hex8, Bricks>(threads, 26, 6);
}
TEST_CASE("tables of a mesh of degree two that changed are those made anew", "[openmp]") {
  using Curved = Formulation<Tet10, Gauss<2>, NeoHookean>;
  for (int threads : {1, 3}) compare_on<Tet10, Curved>(threads, 15, 6);
}

TEST_CASE("a table knows some patches of a chapter, and plans the others", "[openmp]") {
  using Elements = OpenMP<double>::Elements<4>;
  OpenMP<double> const backend;
  // Eight blocks are eight patches of 2040 elements, of which the first keeps these where the last block has seven more.
  ElementBlocks blocks{{0, 2100, 4080, 6120, 8160, 10200, 12240, 14280, 16320}};
  std::vector<std::array<Index, 4>> rows;
  for (Index e = 0; e < 16320; ++e) rows.push_back({e, e + 1, e + 2, e + 3});
  Index const nodes = 16340;
  Elements const before(backend, rows, 1, {}, nodes, NodeOrder::as_given, blocks);

  ElementBlocks changed{blocks.first, {1, 1, 1, 1, 1, 1, 1, 0}, blocks.first};
  changed.first.back() += 7;
  for (Index e = 0; e < 7; ++e) rows.push_back({e, e + 5, e + 9, e + 30});
  std::vector const others(rows.begin() + 14280, rows.end());
  Elements const after(backend, others, 1, {}, nodes, NodeOrder::as_given, changed, &before);
  CHECK(after.patch_bounds()[1] == before.patch_bounds()[1]);
  CHECK(after.patch_bounds()[2] != before.patch_bounds()[2]);
  Elements const anew(backend, rows, 1, {}, nodes, NodeOrder::as_given, {changed.first});
  CHECK(described(after, 1) == described(anew, 1));
}

}  // namespace pliant::test::changed_fans_test

#pragma once

#include <limits>
#include <numeric>
#include <tuple>

#include "support/formulations.hpp"
#include "support/meshes.hpp"
#include "topology/trees_on.hpp"

// Trees in a backend's memory are coarsened as on the host.
namespace pliant::test::tree_on_coarsening_suite {

template <int Dim>
auto state(Hierarchy<Dim> const& host) {
  auto const& tree = host.tree();
  return std::tuple(listed(tree.cells()), listed(tree.edges()), listed(tree.sides()),
                    listed(tree.lists().rows), tree.node_count());
}

/// Leaves of families, of which one in so many is whole, and most of the others lack a child.
template <int Dim>
std::vector<Index> some_families(Hierarchy<Dim> const& host, std::size_t one_in, Random& random) {
  std::vector<Index> marked;
  for (Index c = 0; c < static_cast<Index>(host.cells().size()); ++c) {
    auto const& cell = host.cell(c);
    if (cell.first_child < 0) continue;
    bool const is_whole = random.below(one_in) == 0;
    for (Index i = 0; i < cell.divided().children; ++i)
      if (host.is_leaf(cell.first_child + i) && (is_whole || random.below(4) != 0))
        marked.push_back(cell.first_child + i);
  }
  return marked;
}

/// Refines and coarsens at random, here and on the host, some changes kept together, some taken back; then merges all.
template <class B, int Dim>
void check_changes(TreeBeside<B>& on, Hierarchy<Dim>& host, int rounds) {
  Random random(5);
  auto kept = host;
  Index merged = 0, taken_back = 0;
  int deepest = 0;
  for (int round = 0; round < rounds; ++round) {
    if (round < 2 || random.below(2) == 0)
      refine_both(on, host, some_leaves(host, host.leaf_count() / 6 + 1, random));
    else
      merged += coarsen_both(on, host, some_families(host, 2, random), random).merged;
    for (Index const c : host.leaves()) deepest = std::max(deepest, int{host.cell(c).level});
    auto const next = random.below(5);
    if (next == 0 && round > 2) {
      on.tree.take_back();
      host = kept;
      check_same(on.tree, host);
      ++taken_back;
    } else if (next < 4) {
      on.tree.keep();
      kept = host;
    }
  }
  CHECK(merged > 3);
  CHECK(taken_back > 0);
  CHECK(deepest > 1);
  on.tree.keep();
}
/// Merges all that can be merged.
template <class B, int Dim>
void merge_all(TreeBeside<B>& on, Hierarchy<Dim>& host) {
  Random random(6);
  while (coarsen_both(on, host, host.leaves(), random).merged > 0) {
  }
}

/// The same from a mesh, back to it, and back to where that began.
template <class B, class M>
void check_changes_of(B const& backend, M const& mesh, int rounds, Index few = TreeView::few) {
  Hierarchy<M::dim> host(mesh);
  auto const first = state(host);
  TreeBeside<B> on(backend, host);
  on.tree.few = few;
  check_changes(on, host, rounds);
  auto const changed = host;
  merge_all(on, host);
  CHECK(std::tuple(listed(on.tree.cells()), listed(on.tree.edges()), listed(on.tree.sides()),
                   listed(on.tree.rows()), on.tree.sizes().nodes) == first);
  on.tree.take_back();
  check_same(on.tree, changed);
}

TEST_CASE("trees of every cell are coarsened in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_changes_of(backend, regular_mesh<Tri3>(5), 20);
    check_changes_of(backend, regular_mesh<Quad4>(5), 20);
    check_changes_of(backend, regular_mesh<Tet4>(2), 14);
    check_changes_of(backend, regular_mesh<Hex8>(3), 14);
    check_changes_of(backend, regular_mesh<Wedge6>(3), 14);
    check_changes_of(backend, regular_mesh<Pyramid5>(2), 14);
    check_changes_of(backend, mixed_mesh(4), 20);
    // of several pages
    check_changes_of(backend, regular_mesh<Tri3>(16), 12);
    check_changes_of(backend, regular_mesh<Tet4>(5), 10);
  });
}

TEST_CASE("what came before all that goes stays where it is in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    constexpr Index few = std::numeric_limits<Index>::min();
    check_changes_of(backend, regular_mesh<Tri3>(5), 30, few);
    check_changes_of(backend, regular_mesh<Quad4>(5), 30, few);
    check_changes_of(backend, regular_mesh<Tet4>(2), 20, few);
    check_changes_of(backend, regular_mesh<Hex8>(3), 20, few);
    check_changes_of(backend, regular_mesh<Wedge6>(3), 20, few);
    check_changes_of(backend, regular_mesh<Pyramid5>(2), 20, few);
    check_changes_of(backend, mixed_mesh(4), 30, few);
    check_changes_of(backend, mesh::raised<Tri6>(regular_mesh<Tri3>(4)), 20, few);
    check_changes_of(backend, regular_mesh<Tri3>(16), 12, few);  // of several pages
    check_changes_of(backend, regular_mesh<Tet4>(5), 10, few);
    // What was refined last goes: all that came before stays.
    auto const mesh = regular_mesh<Tet4>(3);
    Hierarchy<3> host(mesh);
    TreeBeside<B> on(backend, host);
    on.tree.few = few;
    Random random(4);
    refine_both(on, host, some_leaves(host, 2, random));
    auto const before = on.tree.sizes();
    refine_both(on, host, {host.leaves().front(), host.leaves().back()});
    std::vector<Index> made(static_cast<std::size_t>(on.tree.sizes().cells - before.cells));
    std::iota(made.begin(), made.end(), before.cells);
    auto const done = coarsen_both(on, host, made, random);
    CHECK(done.merged > 0);
    CHECK(listed(std::vector{done.staying}) == listed(std::vector{before}));
  });
}

TEST_CASE("trees of quadratic elements are coarsened in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_changes_of(backend, mesh::raised<Tri6>(regular_mesh<Tri3>(4)), 20);
    check_changes_of(backend, mesh::raised<Quad9>(regular_mesh<Quad4>(4)), 20);
    check_changes_of(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(2)), 14);
    check_changes_of(backend, mesh::raised<Hex27>(regular_mesh<Hex8>(3)), 14);
  });
}

/// Finds the nodes that hang by what hung before a refinement or coarsening, several in turn, and some of them nowhere.
template <class B, class M>
void check_hanging_nodes(B const& backend, M const& mesh, int rounds) {
  Hierarchy<M::dim> host(mesh);
  TreeBeside<B> on(backend, host);
  HangingNodesOn<M::dim, B> hanging(backend);
  Random random(7);
  auto const first = host.leaf_count();
  std::size_t most = 0;
  auto const check = [&](auto const& done) {
    check_hanging(backend, host, [&](Index const* row_of_node) {
      return hanging.rows_after(on.tree, done, row_of_node);
    });
    most = std::max(most, host.slaves().size());
  };
  for (int round = 0; round < rounds; ++round) {
    if (round < 2 || random.below(3) == 0)
      check(refine_both(on, host, some_leaves(host, host.leaf_count() / 6 + 1, random)));
    else
      check(coarsen_both(on, host, some_families(host, 2, random), random));
    on.tree.keep();
  }
  CHECK(most > 3);
  while (host.leaf_count() > first) check(coarsen_both(on, host, host.leaves(), random));
  CHECK(host.slaves().empty());
}

TEST_CASE("nodes that hang after a coarsening are found where leaves came", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_hanging_nodes(backend, regular_mesh<Tri3>(6), 16);
    check_hanging_nodes(backend, regular_mesh<Quad4>(6), 16);
    check_hanging_nodes(backend, regular_mesh<Tet4>(3), 12);
    check_hanging_nodes(backend, regular_mesh<Hex8>(4), 12);
    check_hanging_nodes(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(2)), 10);
    check_hanging_nodes(backend, mesh::raised<Hex27>(regular_mesh<Hex8>(3)), 10);
  });
}

/// Gives the children of cells of which all can be merged another degree than these have; returns of how many.
template <int Dim>
int convert_families(Hierarchy<Dim>& host, CellNodes has) {
  std::vector<CellConversion> raised;
  std::vector<Index> lowered;
  int families = 0;
  for (Index c = 0; c < static_cast<Index>(host.cells().size()); ++c) {
    auto const& cell = host.cell(c);
    if (cell.is_split() || !host.tree().can_be_merged(c)) continue;
    ++families;
    auto const has_now = host.cell(cell.first_child).has;
    for (Index i = cell.first_child; i < cell.first_child + cell.divided().children; ++i) {
      if (cell.has == CellNodes::corners && has_now == CellNodes::corners)
        raised.push_back({i, has});
      else if (cell.has != CellNodes::corners && has_now != CellNodes::corners)
        lowered.push_back(i);
    }
  }
  host.raise(raised);
  host.merge({}, lowered);
  return families;
}

/// A mesh of which some leaves got another degree, and some others another shape.
template <class M>
Hierarchy<M::dim> converted(M const& mesh, CellNodes has, Division division, Random& random) {
  Hierarchy<M::dim> host(mesh);
  auto const some = [&](std::size_t one_in) {  // few of those that have parents
    auto leaves = some_leaves(host, one_in, random);
    std::erase_if(leaves, [&](Index c) { return host.cell(c).level > 0 && random.below(8) != 0; });
    return leaves;
  };
  for (int round = 0; round < 2; ++round) {
    host.refine(some_leaves(host, host.leaf_count() / 3, random));
    std::vector<CellConversion> conversions;
    for (Index const c : some(2))
      if (host.cell(c).has == CellNodes::corners) conversions.push_back({c, has});
    host.raise(conversions);
  }
  std::vector<Index> lowered;
  for (Index const c : some(2))
    if (host.cell(c).has != CellNodes::corners) lowered.push_back(c);
  host.merge({}, lowered);
  CHECK(convert_families(host, has) > 0);
  std::vector<CellSplit> splits;
  for (Index const c : some_leaves(host, 6, random))
    if (host.cell(c).has == CellNodes::corners && division != Division::refined)
      splits.push_back({c, division});
  host.split(splits);
  CHECK((division == Division::refined || splits.size() > 1));
  return host;
}
template <class B, class M>
void check_converted(B const& backend, M const& mesh, CellNodes has, Division division) {
  Random random(4);
  auto host = converted(mesh, has, division, random);
  CHECK(host.tree().lists().converted.size() > 2);
  TreeBeside<B> on(backend, host);
  check_same(on.tree, host);
  check_changes(on, host, 14);
  auto const changed = host;
  merge_all(on, host);
  on.tree.take_back();
  check_same(on.tree, changed);
}

TEST_CASE("trees of several degrees and shapes are coarsened in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_converted(backend, regular_mesh<Tri3>(5), CellNodes::edges, Division::refined);
    check_converted(backend, regular_mesh<Quad4>(6), CellNodes::all, Division::four_triangles);
    check_converted(backend, regular_mesh<Tet4>(3), CellNodes::edges, Division::refined);
    check_converted(backend, regular_mesh<Hex8>(4), CellNodes::all, Division::six_pyramids);
    check_converted(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(3)), CellNodes::edges,
                    Division::refined);
  });
}

/// The nodes that hang in such a mesh, from its first change on and at the end.
template <class B, class M>
void check_hanging_of(B const& backend, M const& mesh, CellNodes has, Division division) {
  Random random(8);
  for (int one = 0; one < 4; ++one) {
    auto host = converted(mesh, has, division, random);
    TreeBeside<B> on(backend, host);
    REQUIRE(on.tree.mixes_degrees());
    HangingNodesOn<M::dim, B> hanging(backend), again(backend);
    auto const find = [&](Index const* row_of_node) { return again.rows(on.tree, row_of_node); };
    check_hanging(backend, host, find);
    auto const check = [&](auto const& done) {
      check_hanging(backend, host, [&](Index const* row_of_node) {
        return hanging.rows_after(on.tree, done, row_of_node);
      });
    };
    for (int round = 0; round < 5; ++round) {
      if (round % 2 == 0)
        check(refine_both(on, host, some_leaves(host, host.leaf_count() / 6 + 1, random)));
      else
        check(coarsen_both(on, host, some_families(host, 2, random), random));
      on.tree.keep();
    }
    merge_all(on, host);
    check_hanging(backend, host, find);
    CHECK(host.slaves().size() > 10);  // of other degrees
  }
}

TEST_CASE("nodes that hang in a tree of several degrees are found in a backend's memory",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_hanging_of(backend, regular_mesh<Tri3>(5), CellNodes::edges, Division::refined);
    check_hanging_of(backend, regular_mesh<Quad4>(6), CellNodes::edges, Division::refined);
    check_hanging_of(backend, regular_mesh<Quad4>(6), CellNodes::all, Division::four_triangles);
    check_hanging_of(backend, regular_mesh<Tet4>(3), CellNodes::edges, Division::refined);
    check_hanging_of(backend, regular_mesh<Hex8>(4), CellNodes::edges, Division::refined);
    check_hanging_of(backend, regular_mesh<Hex8>(4), CellNodes::all, Division::six_pyramids);
    check_hanging_of(backend, mesh::raised<Quad9>(regular_mesh<Quad4>(5)), CellNodes::all,
                     Division::refined);
    check_hanging_of(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(3)), CellNodes::edges,
                     Division::refined);
    check_hanging_of(backend, mesh::raised<Hex27>(regular_mesh<Hex8>(3)), CellNodes::all,
                     Division::refined);
  });
}

TEST_CASE("families that have a reason to stay are not merged in a backend's memory",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<2> host(regular_mesh<Quad4>(2));  // two side by side
    REQUIRE(host.cells().size() == 2);
    TreeBeside<B> on(backend, host);
    refine_both(on, host, {0, 1});
    refine_both(on, host, {6});  // a corner of cell 1 at cell 0
    REQUIRE(host.cells().size() == 14);
    auto const merged = [&](std::vector<Index> const& marked) {
      auto const before = state(host);
      auto const done = on.coarsen(marked);
      if (done.merged == 0) {
        CHECK(done.parents == nullptr);
        check_same(on.tree, host);
      }
      return done.merged;
    };
    on.tree.keep();
    CHECK(merged({}) == 0);
    CHECK(merged({2, 3, 4, 5}) == 0);           // beside cells two levels finer
    CHECK(merged({6, 7, 8, 9}) == 0);           // one of them is divided
    CHECK(merged({7, 8, 9, 10, 11, 12}) == 0);  // not all are marked
    CHECK(merged({0, 1, 6, 7}) == 0);
    CHECK(merged({2, 3, 4, 5, 10, 11, 12, 13}) == 1);  // what is finer goes as late
    on.tree.take_back();
    CHECK(merged({10, 13, 11, 12, 10}) == 1);
    CHECK(merged({6, 7, 8, 9, 2, 5, 4, 3}) == 2);
    CHECK(on.tree.sizes().cells == 2);
    on.tree.take_back();
    check_same(on.tree, host);
  });
}

TEST_CASE("a coarsening far from other refined cells is taken back there too", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Tet4>(6));
    Index const far = 600;
    REQUIRE(far / static_cast<Index>(Page<TreeCell>::entries) > 0);
    REQUIRE(host.cells().size() > far + Page<TreeCell>::entries);
    TreeBeside<B> on(backend, host);
    refine_both(on, host, {far});
    refine_both(on, host, {0});
    on.tree.keep();
    auto const before = host;
    Random random(1);
    Index const child = host.cell(far).first_child;
    std::vector<Index> family(8);
    std::iota(family.begin(), family.end(), child);
    CHECK(coarsen_both(on, host, family, random).merged == 1);
    CHECK(host.cell(0).first_child == child);
    on.tree.take_back();
    check_same(on.tree, before);
  });
}

TEST_CASE("memory of a tree that is refined and coarsened again and again does not grow",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Tet4>(4));
    TreeBeside<B> on(backend, host);
    Random random(2);
    auto const marked = some_leaves(host, 4, random);
    auto const coarsen_all = [&] {
      std::vector<Index> cells(static_cast<std::size_t>(on.tree.sizes().cells));
      std::iota(cells.begin(), cells.end(), Index{0});
      return on.coarsen(cells).merged;
    };
    std::size_t bytes = 0;
    for (int round = 0; round < 30; ++round) {
      on.refine(marked);
      on.tree.keep();
      if (round % 3 == 1) {
        REQUIRE(coarsen_all() > 0);
        on.tree.take_back();
      }
      while (coarsen_all() > 0) {
      }
      if (round % 2 == 0) on.refine(marked);  // kept together
      while (coarsen_all() > 0) {
      }
      on.tree.keep();
      if (round == 3) bytes = on.tree.bytes();
      if (round > 3) CHECK(on.tree.bytes() == bytes);
    }
    check_same(on.tree, host);
  });
}

}  // namespace pliant::test::tree_on_coarsening_suite

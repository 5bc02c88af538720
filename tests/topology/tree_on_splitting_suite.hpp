#pragma once

#include <pliant/backend/field.hpp>
#include <pliant/topology/marked_elements.hpp>

#include "support/formulations.hpp"
#include "support/meshes.hpp"
#include "topology/trees_on.hpp"

// Cells of trees in a backend's memory are split into such of other shapes, and merged, as on the host.
namespace pliant::test::tree_on_splitting_suite {

/// The points of a tree's nodes in a backend's memory, at rows of their own numbers, backwards.
template <class B, int Dim>
class Points {
 public:
  Points(B const& backend, Hierarchy<Dim> const& host) {
    std::vector<Index> backwards(host.points().size());
    std::iota(backwards.rbegin(), backwards.rend(), Index{0});
    std::vector<double> values(node_stride * backwards.size());
    for (std::size_t node = 0; node < backwards.size(); ++node)
      for (std::size_t k = 0; k < std::size_t{Dim}; ++k)
        values[node_stride * static_cast<std::size_t>(backwards[node]) + k] =
            host.points()[node][k];
    of_node_ = upload(backend, backwards);
    points_ = upload(backend, values);
  }
  [[nodiscard]] NodesAtRest<Dim> view() const { return {{points_.data()}, of_node_.data()}; }

 private:
  typename B::template Array<Index> of_node_;
  typename B::template Array<double> points_;
};

inline bool has_parts(TreeCell const& cell) {
  return cell.has == CellNodes::corners &&
         (cell.kind == CellKind::quadrilateral || cell.kind == CellKind::hexahedron ||
          cell.kind == CellKind::pyramid);
}
/// With some of them again, with cells that cannot be split, and none.
template <int Dim>
std::vector<Index> with_others(Hierarchy<Dim> const& host, std::vector<Index> marked,
                               Random& random) {
  std::vector<Index> more{-1};
  for (Index const c : marked)
    if (random.below(3) == 0) more.push_back(c);
  for (Index c = 0; c < static_cast<Index>(host.cells().size()); ++c)
    if (!host.is_leaf(c) || !has_parts(host.cell(c))) more.push_back(c);
  marked.insert(marked.end(), more.begin(), more.end());
  random.shuffle(marked);
  return marked;
}

/// Splits some leaves, here and on the host.
template <class B, int Dim>
auto split_both(TreeBeside<B>& on, Hierarchy<Dim>& host, std::size_t one_in, Random& random) {
  auto const some = [&] {
    auto leaves = some_leaves(host, one_in, random);
    std::erase_if(leaves, [&](Index c) { return !has_parts(host.cell(c)); });
    return leaves;
  };
  auto const marked = some(), in_two = some();
  auto const list = upload(on.backend, with_others(host, marked, random)),
             two = upload(on.backend, with_others(host, in_two, random));
  Points<B, Dim> const points(on.backend, host);
  auto const done = on.tree.split(
      {list.data(), static_cast<Index>(list.size()), two.data(), static_cast<Index>(two.size())},
      points.view());
  auto const wanted =
      detail::change_cells(host, {.split = detail::splits_of(host, marked, in_two)}, {}, {});
  host = *wanted.tree;
  REQUIRE(done.leaves == static_cast<Index>(wanted.split.size()));
  CHECK(numbers_of(on.taken(done.cells, done.leaves), &CellSplit::cell) == wanted.split);
  REQUIRE(done.new_nodes == static_cast<Index>(wanted.added.size()));
  std::vector<Index> nodes;
  for (auto const& node : wanted.added) nodes.push_back(node.node);
  CHECK(numbers_of(on.taken(done.nodes, done.new_nodes), &PlacedNode::node) == nodes);
  check_same(on.tree, host);
  return done;
}
/// Merges all families of split cells of which marked leaves are all.
template <class B, int Dim>
Merged merge_both(TreeBeside<B>& on, Hierarchy<Dim>& host, std::vector<Index> const& marked) {
  auto const parents = detail::merged_splits(host, marked);
  auto const list = upload(on.backend, marked);
  auto const done = on.tree.merge(list.data(), static_cast<Index>(list.size()));
  host.merge(parents);
  REQUIRE(done.merged == static_cast<Index>(parents.size()));
  if (!parents.empty()) CHECK(on.taken(done.parents, done.merged) == parents);
  check_same(on.tree, host);
  return done;
}

/// Changes at random, here and on the host, some kept together, some taken back; then back to the first mesh.
template <class B, class M>
void check_splits(B const& backend, M const& mesh, int rounds) {
  Hierarchy<M::dim> host(mesh);
  TreeBeside<B> on(backend, host);
  HangingNodesOn<M::dim, B> hanging(backend);
  auto const first = host;
  auto kept = host;
  Random random(3);
  Index split = 0, merged = 0, of_refined = 0, taken_back = 0;
  for (int round = 0; round < rounds; ++round) {
    auto const check_after = [&](auto const& done) {
      check_hanging(backend, host,
                    [&](Index const* rows) { return hanging.rows_after(on.tree, done, rows); });
    };
    auto const next = round < 2 ? round : static_cast<int>(random.below(4));
    if (next == 0) {
      check_after(refine_both(on, host, some_leaves(host, host.leaf_count() / 5 + 1, random)));
    } else if (next == 1) {
      auto const done = split_both(on, host, 3, random);
      split += done.leaves;
      check_after(done);
    } else if (next == 2) {
      auto most = host.leaves();
      std::erase_if(most, [&](Index) { return random.below(12) == 0; });
      auto const done = merge_both(on, host, most);
      merged += done.merged;
      check_after(done);
    } else {
      auto const done = coarsen_both(on, host, host.leaves(), random);
      of_refined += done.merged;
      check_after(done);
    }
    if (round % 5 == 4) {
      on.tree.take_back();
      host = kept;
      hanging = HangingNodesOn<M::dim, B>(backend);
      (void)hanging.rows(on.tree, Points<B, M::dim>(backend, host).view().of_node);
      check_same(on.tree, host);
      ++taken_back;
    } else if (random.below(3) > 0) {
      on.tree.keep();
      kept = host;
    }
  }
  CHECK(split > 10);
  CHECK(merged > 3);
  CHECK(of_refined > 0);
  CHECK(taken_back > 0);
  while (coarsen_both(on, host, host.leaves(), random).merged +
             merge_both(on, host, host.leaves()).merged >
         0) {
  }
  check_same(on.tree, first);
}

TEST_CASE("cells are split in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_splits(backend, distorted_mesh<Quad4>(6), 40);
    check_splits(backend, mixed_mesh(5), 40);
    check_splits(backend, distorted_mesh<Hex8>(3), 40);
    check_splits(backend, regular_mesh<Pyramid5>(2), 30);
  });
}

TEST_CASE("a tree whose cells would be split into too many is as it was", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Hex8>(3));
    TreeBeside<B> on(backend, host);
    Points<B, 3> const points(backend, host);
    auto const list = upload(backend, std::vector<Index>{2, 5});
    RefinementLimits const limits{.leaves = host.leaf_count() + 9};
    CHECK_THROWS_WITH(on.tree.split({list.data(), 2}, points.view(), limits),
                      says("split 2 cells") && says("leaves in all"));
    check_same(on.tree, host);
    CHECK(on.tree.split({list.data(), 2}, points.view(), {.leaves = limits.leaves + 1}).leaves ==
          2);
    on.tree.take_back();
    check_same(on.tree, host);
  });
}

}  // namespace pliant::test::tree_on_splitting_suite

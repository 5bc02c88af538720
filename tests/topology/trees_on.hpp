#pragma once

#include <numeric>

#include <pliant/topology/hanging_nodes_on.hpp>
#include <pliant/topology/hierarchy.hpp>
#include <pliant/topology/tree_on.hpp>

#include "support/backends.hpp"
#include "support/catch.hpp"
#include "topology/tree_states.hpp"

// What tests of trees in a backend's memory share.
namespace pliant::test {

/// A tree in a backend's memory, beside one on the host.
template <Backend B>
struct TreeBeside {
  B backend;
  TreeOn<B> tree;

  template <int Dim>
  TreeBeside(B const& on, Hierarchy<Dim> const& like)
      : backend(on), tree(backend, like.tree().lists(), *like.tree().cells_at_edges()) {}

  auto refine(std::vector<Index> const& marked, RefinementLimits const& limits = {}) {
    auto const list = upload(backend, marked);
    return tree.refine(list.data(), static_cast<Index>(marked.size()), limits);
  }
  auto coarsen(std::vector<Index> const& marked) {
    auto const list = upload(backend, marked);
    return tree.coarsen(list.data(), static_cast<Index>(marked.size()));
  }
  /// Values that a change gave, on the host.
  template <class V>
  std::vector<V> taken(V const* values, Index count) {
    auto array = zeros<V>(backend, static_cast<std::size_t>(count));
    detail::copy_values(backend, values, array.data(), static_cast<std::size_t>(count));
    return download<V>(array);
  }
};

template <class B, int Dim>
void check_same(TreeOn<B>& tree, Hierarchy<Dim> const& host) {
  auto const& like = host.tree();
  CHECK(listed(tree.cells()) == listed(like.cells()));
  CHECK(listed(tree.edges()) == listed(like.edges()));
  CHECK(listed(tree.sides()) == listed(like.sides()));
  CHECK(listed(tree.rows()) == listed(like.lists().rows));
  CHECK(tree.sizes().nodes == like.node_count());
  CHECK(tree.leaves() == static_cast<Index>(host.leaf_count()));
}

/// The same hanging nodes with the same masters and weights; nodes have rows of their own numbers, backwards. find(row_of_node):
/// the rows that are compared.
template <class B, int Dim, class Find>
void check_hanging(B const& backend, Hierarchy<Dim> const& host, Find const& find) {
  std::vector<Index> backwards(host.points().size());
  std::iota(backwards.rbegin(), backwards.rend(), Index{0});
  auto const row_of_node = upload(backend, backwards);
  RowsOn<B> const rows = find(row_of_node.data());
  auto const node = download<Index>(rows.node), first = download<Index>(rows.first),
             other = download<Index>(rows.other);
  auto const weight = download<double>(rows.weight);
  auto const wanted = host.slaves();
  REQUIRE(rows.count == static_cast<Index>(wanted.size()));
  int wrong = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    auto const& slave = wanted[k];
    auto const from = static_cast<std::size_t>(first[k]),
               to = static_cast<std::size_t>(first[k + 1]);
    REQUIRE(to - from == slave.masters.size());
    wrong += node[k] != backwards[static_cast<std::size_t>(slave.node)];
    for (std::size_t m = 0; m < slave.masters.size(); ++m) {
      auto const& master = slave.masters[m];
      wrong += other[from + m] != backwards[static_cast<std::size_t>(master.first)];
      wrong += weight[from + m] != master.second;
    }
  }
  CHECK(wrong == 0);
}

template <class V>
std::vector<Index> numbers_of(std::vector<V> const& list, Index V::*number) {
  std::vector<Index> numbers;
  for (auto const& own : list) numbers.push_back(own.*number);
  return numbers;
}

template <int Dim>
std::vector<Index> some_leaves(Hierarchy<Dim> const& tree, std::size_t one_in, Random& random) {
  auto leaves = tree.leaves();
  std::erase_if(leaves, [&](Index) { return random.below(one_in) != 0; });
  return leaves;
}

/// Merges families of marked leaves here and on the host.
template <class B, int Dim>
Coarsened coarsen_both(TreeBeside<B>& on, Hierarchy<Dim>& host, std::vector<Index> const& marked,
                       Random& random) {
  auto const parents = host.families(marked);
  auto const before = on.tree.sizes();
  auto more = marked;  // some of them again, and cells that are no leaves
  for (Index const c : marked)
    if (random.below(3) == 0) more.push_back(c);
  for (Index c = 0; c < before.cells; ++c)
    if (!host.is_leaf(c) && random.below(2) == 0) more.push_back(c);
  random.shuffle(more);
  auto const done = on.coarsen(more);
  auto const wanted = host.merge(parents);
  REQUIRE(done.merged == static_cast<Index>(parents.size()));
  CHECK(done.before.cells == before.cells);
  CHECK(listed(std::vector{done.now}) == listed(std::vector{on.tree.sizes()}));
  check_same(on.tree, host);
  if (parents.empty()) return done;
  CHECK(on.taken(done.parents, done.merged) == parents);
  auto const check_numbers = [](NumberMap const& host_has, Index first, Index count,
                                std::vector<Index> const& numbers) {
    int wrong = 0;
    for (Index k = 0; k < count; ++k)
      wrong += host_has[k] != (k < first ? k : numbers[static_cast<std::size_t>(k - first)]);
    CHECK(wrong == 0);
  };
  auto const& staying = done.staying;
  check_numbers(wanted.renumbered.nodes, staying.nodes, before.nodes,
                on.taken(done.nodes, before.nodes - staying.nodes));
  check_numbers(wanted.renumbered.cells, staying.cells, before.cells,
                on.taken(done.cells, before.cells - staying.cells));
  return done;
}
template <class B, int Dim>
auto refine_both(TreeBeside<B>& on, Hierarchy<Dim>& host, std::vector<Index> const& marked) {
  auto const done = on.refine(marked);
  auto const wanted = host.refine(marked);
  REQUIRE(done.leaves == static_cast<Index>(wanted.parents.size()));
  REQUIRE(done.new_nodes == static_cast<Index>(wanted.new_nodes.size()));
  std::vector<Index> nodes;
  for (auto const& node : wanted.new_nodes) nodes.push_back(node.node);
  CHECK(numbers_of(on.taken(done.nodes, done.new_nodes), &PlacedNode::node) == nodes);
  check_same(on.tree, host);
  return done;
}

}  // namespace pliant::test

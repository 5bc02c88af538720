#pragma once

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
  CHECK(tree.sizes().nodes == like.node_count());
  CHECK(tree.leaves() == static_cast<Index>(host.leaf_count()));
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

}  // namespace pliant::test

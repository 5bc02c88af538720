#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

namespace detail {

struct CountLeaf {
  TreeView tree;
  PLIANT_HOST_DEVICE Index operator()(Index c) const { return tree.is_leaf(c) ? 1 : 0; }
};
/// By the place of a leaf: its rank; and by the rank: the leaf.
struct PutNumbers {
  Index const *leaves, *rank;
  Index *numbers, *cells;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = leaves[i], own = rank[cell];
    numbers[i] = own;
    cells[own] = cell;
  }
};

}  // namespace detail

/// The user's numbers of the elements of a mesh of one type, in a backend's memory: leaves of the tree have theirs in the order of
/// their cells (see CellSet).
template <Backend B>
class ElementNumbersOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  ElementNumbersOn() = default;
  /// Finds the numbers of the leaves that there are now.
  ElementNumbersOn(B const& backend, TreeOn<B> const& tree, LeafOrderOn<B> const& order) {
    find(backend, tree, order);
  }

  [[nodiscard]] Index count() const { return count_; }
  /// By the place in the order of the elements.
  [[nodiscard]] Index const* numbers() const { return numbers_.data(); }
  /// The cells of elements by the user's numbers, ascending.
  [[nodiscard]] Index const* cells() const { return cells_.data(); }

  /// The same after a change.
  void find(B const& backend, TreeOn<B> const& tree, LeafOrderOn<B> const& order) {
    Index const cells = tree.sizes().cells;
    count_ = order.count();
    detail::grow(backend, rank_, static_cast<std::size_t>(cells) + 1);
    detail::grow(backend, numbers_, static_cast<std::size_t>(count_));
    detail::grow(backend, cells_, static_cast<std::size_t>(count_));
    backend.scan(cells, detail::CountLeaf{tree.view()}, rank_.data());
    backend.for_each(
        count_, detail::PutNumbers{order.leaves(), rank_.data(), numbers_.data(), cells_.data()});
  }

 private:
  Array<Index> rank_, numbers_, cells_;
  Index count_ = 0;
};

}  // namespace pliant

#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/element/element.hpp>
#include <pliant/topology/rows_of_element.hpp>
#include <pliant/topology/tree_on.hpp>

// The elements of a mesh of one type after a refinement, in a backend's memory: what belongs to each is taken from where it
// was before, or comes from the tree.
namespace pliant {

namespace detail {

/// Puts the rows of nodes of elements, `Width` entries of which the first are the nodes.
template <Element E, int Width>
struct PutElementRows {
  TreeView tree;
  Index const* leaves;
  Index const *leaves_before, *from;
  ElementRows before;    // null: all come from the tree
  Index const* of_node;  // rows of fields
  Index* to;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = leaves[i];
    Index* const row = to + static_cast<std::ptrdiff_t>(Width) * i;
    if (before.nodes != nullptr && leaves_before[from[i]] == cell) {
      Index const* const own = before[from[i]];
      for (int a = 0; a < Width; ++a) row[a] = own[a];
    } else {
      auto const own = rows_of_element<E>(tree, cell, of_node);
      for (std::size_t a = 0; a < own.size(); ++a) row[a] = own[a];
    }
  }
};

/// Whether the leaf at a place was not there before.
struct IsNewLeaf {
  Index const *leaves, *leaves_before, *from;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return leaves_before[from[i]] != leaves[i]; }
};
/// Whether the leaf that was at a place is divided.
struct WasDivided {
  TreeView tree;
  Index const* leaves_before;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return !tree.is_leaf(leaves_before[i]); }
};

/// to[i] = from[places[i]] in each of several columns.
template <class U>
struct InheritValues {
  Index const* places;
  U const* from;
  U* to;
  Index count_before, count, columns;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (Index k = 0; k < columns; ++k)
      to[static_cast<std::ptrdiff_t>(count) * k + i] =
          from[static_cast<std::ptrdiff_t>(count_before) * k + places[i]];
  }
};

}  // namespace detail

/// The rows of nodes of all elements after a refinement, for elements_of_rows: (elements, Width). Those of leaves that were
/// there before are taken from `before`, the rows of the table of then; without nodes there, all come from the tree.
/// `of_node`: the row of each node, by the user's number, in the backend's memory.
template <Element E, int Width, Backend B>
typename B::template Array<Index> element_rows(B const& backend, TreeView const& tree,
                                               LeafOrderOn<B> const& order, Index const* of_node,
                                               ElementRows const& before = {nullptr, Width}) {
  static_assert(Width >= E::nodes);
  auto rows = zeros<Index>(backend, static_cast<std::size_t>(order.count()) * Width);
  backend.for_each(order.count(),
                   detail::PutElementRows<E, Width>{tree, order.leaves(), order.before(),
                                                    order.from(), before, of_node, rows.data()});
  return rows;
}

/// The blocks of the elements after a refinement; those of which no leaf was divided stay, as they have as many leaves as before.
/// `first_before`: the blocks before it. Waits for the backend.
template <Backend B>
ElementBlocks blocks_after_refinement(LeafOrderOn<B> const& order,
                                      std::vector<Index> first_before) {
  ElementBlocks blocks{order.download_first_of_block(), {}, std::move(first_before)};
  auto const &now = blocks.first, &then = blocks.first_before;
  for (std::size_t b = 0; b + 1 < now.size(); ++b)
    blocks.stays.push_back(now[b + 1] - now[b] == then[b + 1] - then[b] ? 1 : 0);
  return blocks;
}

/// Values per element after a refinement, (columns, elements): each has those that it had before, or that its parent had.
template <class U, Backend B>
typename B::template Array<U> inherited_values(B const& backend, LeafOrderOn<B> const& order,
                                               U const* before, Index columns = 1) {
  auto values = zeros<U>(
      backend, static_cast<std::size_t>(order.count()) * static_cast<std::size_t>(columns));
  backend.for_each(order.count(),
                   detail::InheritValues<U>{order.from(), before, values.data(),
                                            order.count_before(), order.count(), columns});
  return values;
}

/// The places of the elements that come in a refinement, and of those that go, before it; ascending, in a backend's memory.
template <Backend B>
struct RefinedPlaces {
  typename B::template Array<Index> come, go;
  Index come_count = 0, go_count = 0;

  /// `divided`: how many leaves were. Waits for nothing.
  RefinedPlaces(B const& backend, TreeView const& tree, LeafOrderOn<B> const& order, Index divided)
      : come_count(order.count() - order.count_before() + divided), go_count(divided) {
    come = zeros<Index>(backend, static_cast<std::size_t>(come_count) + 1);
    go = zeros<Index>(backend, static_cast<std::size_t>(go_count) + 1);
    // How many there are is behind them.
    backend.select(order.count(), detail::IsNewLeaf{order.leaves(), order.before(), order.from()},
                   come.data(), come.data() + come_count);
    backend.select(order.count_before(), detail::WasDivided{tree, order.before()}, go.data(),
                   go.data() + go_count);
  }
};

}  // namespace pliant

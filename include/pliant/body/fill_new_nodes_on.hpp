#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/field.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/element/element.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

namespace detail {

/// Gives a new node the weighted sums of what the nodes have that its cell had, as Transfer::fill_new_nodes does: sums are of
/// doubles, and what all have is not rounded.
template <Element E, class... T>
struct FillNewNodes {
  static constexpr int dim = E::dim;
  TreeView tree;
  PlacedNode const* nodes;
  bool has_others;       // whether they may lie in cells of other types
  Index const* of_node;  // rows, by the user's number
  std::tuple<NodeField<T, dim>...> fields;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    PlacedNode const& placed = nodes[k];
    if (!cells_of_type<E>(has_others).made(tree, placed)) return;
    Vector<double, dim> xi;
    for (int d = 0; d < dim; ++d) xi[d] = placed.place[static_cast<std::size_t>(d)];
    auto const weights = E::shape(xi);
    auto const rows = rows_of_parents(placed.cell, weights);
    Index const row = of_node[placed.node];
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (fill(std::get<I>(fields), row, rows, weights), ...);
    }(std::index_sequence_for<T...>());
  }

 private:
  using Rows = std::array<Index, static_cast<std::size_t>(E::nodes)>;

  /// −1: the weight is zero.
  template <class Weights>
  [[nodiscard]] PLIANT_HOST_DEVICE Rows rows_of_parents(Index cell, Weights const& weights) const {
    Rows rows;
    auto const take = [&](auto const& parents) {
      for (std::size_t a = 0; a < rows.size(); ++a)
        rows[a] = weights[static_cast<int>(a)] != 0 ? of_node[parents[a]] : -1;
    };
    if constexpr (E::degree == 1)
      take(tree.row(cell).nodes);
    else
      take(tree.nodes_of(cell));
    return rows;
  }
  template <class U, class Weights>
  static PLIANT_HOST_DEVICE void fill(NodeField<U, dim> field, Index row, Rows const& rows,
                                      Weights const& weights) {
    using S = Uncontracted;
    auto first = Vector<U, dim>::zero();
    auto sum = Vector<S, dim>::zero();
    bool same = true, none = true;
    for (std::size_t a = 0; a < rows.size(); ++a) {
      if (rows[a] < 0) continue;
      auto const value = field.at(rows[a]);
      if (none) first = value;
      none = false;
      for (int d = 0; d < dim; ++d) {
        same = same && value[d] == first[d];
        sum[d] += S(weights[static_cast<int>(a)]) * S(value[d]);
      }
    }
    if (!same)
      for (int d = 0; d < dim; ++d) first[d] = static_cast<U>(sum[d].value);
    field.set(row, first);
  }
};

}  // namespace detail

/// A step (see in_turn) that gives the nodes that a change made, a TreeOn::Refined or Raised, the values of fields where they lie in
/// the cells that were elements of a type; all were, but for a tree that `has_others`. `of_node`: rows by the user's numbers, in the backend's memory, those
/// of new nodes with them.
template <Element E, Backend B, class Made, class... T>
auto filling_new_nodes(TreeOn<B> const& tree, Made const& made, bool has_others,
                       Index const* of_node, NodeField<T, E::dim>... fields) {
  return detail::LoopStep{
      made.new_nodes,
      detail::FillNewNodes<E, T...>{tree.view(), made.nodes, has_others, of_node, {fields...}}};
}

}  // namespace pliant

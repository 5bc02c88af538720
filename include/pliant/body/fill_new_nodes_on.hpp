#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/field.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

namespace detail {

/// Gives a new node the weighted sum of what the nodes have that its cell had, as Transfer::fill_new_nodes does: sums are of
/// doubles, and what all have is not rounded.
template <Element E, class T, int Dim>
struct FillNewNodes {
  TreeView tree;
  PlacedNode const* nodes;
  Index const* of_node;  // rows, by the user's number
  NodeField<T, Dim> field;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    using S = Uncontracted;
    PlacedNode const& placed = nodes[k];
    auto const parents = shape_weights<E>(tree.nodes_of(placed.cell), placed.place);
    auto first = Vector<T, Dim>::zero();
    auto sum = Vector<S, Dim>::zero();
    bool same = true;
    for (std::size_t p = 0; p < parents.size(); ++p) {
      auto const value = field.at(of_node[parents[p].first]);
      if (p == 0) first = value;
      for (int d = 0; d < Dim; ++d) {
        same = same && value[d] == first[d];
        sum[d] += S(parents[p].second) * S(value[d]);
      }
    }
    if (!same)
      for (int d = 0; d < Dim; ++d) first[d] = static_cast<T>(sum[d].value);
    field.set(of_node[placed.node], first);
  }
};

}  // namespace detail

/// A step (see in_turn) that gives the nodes that a refinement made the values of a field where they lie in the cells that were
/// refined. All cells of the tree are elements of one type. `of_node`: rows by the user's numbers, in the backend's memory, those
/// of new nodes with them.
template <Element E, Backend B, class T, int Dim>
auto filling_new_nodes(TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined,
                       Index const* of_node, NodeField<T, Dim> field) {
  return detail::LoopStep{refined.new_nodes, detail::FillNewNodes<E, T, Dim>{
                                                 tree.view(), refined.nodes, of_node, field}};
}

}  // namespace pliant

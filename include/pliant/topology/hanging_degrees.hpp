#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/hanging_view.hpp>

// Passes that find what hangs in trees that mix degrees: displacements are of the lowest degree of all leaves around.
namespace pliant::detail {

/// Marks an edge on which the displacement is linear, and those of which it is a part.
struct MarkLinear {
  TreeView tree;
  std::uint8_t* linear;  // by edge
  PLIANT_HOST_DEVICE void mark(Index e) const {
    for (; e >= 0; e = tree.edges[static_cast<std::size_t>(e)].parent()) linear[e] = 1;
  }
};
/// Those of leaves that have corners only.
struct MarkLinearEdges : MarkLinear {
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    if (tree.edges[static_cast<std::size_t>(e)].is_linear()) mark(e);
  }
};
/// And those of sides on which nodes hang and displacements are linear, of one level: finer ones go first, as their edges may lie
/// between parts of coarser ones.
template <int Dim>
struct MarkLinearSides : MarkLinear {
  int level;
  PLIANT_HOST_DEVICE void operator()(Index s) const {
    HangingView<Dim> const view{tree, linear};
    auto const& own = tree.sides[static_cast<std::size_t>(s)];
    if (own.level != level || !view.is_hung_on_side(s) || view.nodes_on(own) != CellNodes::corners)
      return;
    for (std::size_t k = 0; k < own.corners(); ++k) mark(own.edges[k]);
  }
};
/// The levels of sides on which nodes hang; −1 of others.
template <int Dim>
struct LevelOfHungSide {
  HangingView<Dim> view;
  PLIANT_HOST_DEVICE double operator()(Index s) const {
    return view.is_hung_on_side(s) ? view.tree.sides[static_cast<std::size_t>(s)].level : -1;
  }
};

/// Whether nodes hang on an edge, divided or not.
template <int Dim>
struct IsHungOnAnyEdge {
  HangingView<Dim> view;
  PLIANT_HOST_DEVICE bool operator()(Index e) const {
    auto const& own = view.tree.edges[static_cast<std::size_t>(e)];
    if (own.first_half >= 0) return view.is_hung_on_edge(e);
    return own.cells.leaves() > 0 && own.middle >= 0 && view.is_linear(e);
  }
};
/// The same of a side.
template <int Dim>
struct IsHungOnAnySide {
  HangingView<Dim> view;
  PLIANT_HOST_DEVICE bool operator()(Index s) const {
    auto const& own = view.tree.sides[static_cast<std::size_t>(s)];
    if (own.first_child >= 0) return view.is_hung_on_side(s);
    return own.centre >= 0 && view.nodes_on(own) != CellNodes::all;
  }
};
/// Whether the node in the middle of a leaf is none of its element's.
struct IsHungInCell {
  TreeView tree;
  PLIANT_HOST_DEVICE bool operator()(Index c) const {
    auto const& own = tree.cells[static_cast<std::size_t>(c)];
    return own.first_child < 0 && own.centre >= 0 && own.has != CellNodes::all;
  }
};

/// Whether an entry of sorted ones is the first of its value.
struct IsFirstOfEqual {
  std::uint64_t const* sorted;
  PLIANT_HOST_DEVICE bool operator()(Index k) const { return k == 0 || sorted[k] != sorted[k - 1]; }
};
/// Slaves at some places of sorted ones.
struct TakeSlaves {
  Index const* places;
  std::uint64_t const* nodes;
  Index const* order;
  std::uint64_t* nodes_taken;
  Index* order_taken;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    nodes_taken[k] = nodes[places[k]];
    order_taken[k] = order[places[k]];
  }
};

/// On which edges of a tree in a backend's memory displacements are linear.
template <int Dim, Backend B>
class LinearEdgesOn {
 public:
  /// Finds them; nodes may hang on so many sides. Waits, where there are any.
  HangingView<Dim> find(B const& backend, TreeView const& tree, Index edges, Index sides) {
    grow(backend, linear_, static_cast<std::size_t>(edges));
    auto* const linear = linear_.data();
    MarkLinear const marking{tree, linear};
    in_turn(backend, LoopStep{edges, FillValue<std::uint8_t>{linear, 0}},
            LoopStep{edges, MarkLinearEdges{marking}});
    HangingView<Dim> const hanging{tree, linear};
    if (sides == 0) return hanging;
    auto const finest = static_cast<int>(backend.maximum(sides, LevelOfHungSide<Dim>{hanging}));
    for (int level = finest; level >= 0; --level)
      backend.for_each(sides, MarkLinearSides<Dim>{marking, level});
    return hanging;
  }
  [[nodiscard]] std::uint8_t const* data() const { return linear_.data(); }

 private:
  typename B::template Array<std::uint8_t> linear_;  // by edge
};

/// Leaves each slave once, where they hang at several places.
template <Backend B>
class SlavesOnce {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// Of n sorted slaves, and their places, leaves the first of equal ones; gives how many are left. Waits.
  Index keep(B const& backend, Index n, Array<std::uint64_t>& nodes, Array<Index>& order) {
    auto const most = static_cast<std::size_t>(n);
    if (told_.size() == 0) told_ = ReadBack<B, Index>(backend, 1);
    grow(backend, first_, most);
    grow(backend, nodes_, most);
    grow(backend, order_, most);
    backend.select(n, IsFirstOfEqual{nodes.data()}, first_.data(), told_.data());
    backend.synchronize();
    Index const count = told_.template first<1>()[0];
    backend.for_each(
        count, TakeSlaves{first_.data(), nodes.data(), order.data(), nodes_.data(), order_.data()});
    std::swap(nodes, nodes_);
    std::swap(order, order_);
    return count;
  }

 private:
  Array<Index> first_, order_;
  Array<std::uint64_t> nodes_;
  ReadBack<B, Index> told_;
};

}  // namespace pliant::detail

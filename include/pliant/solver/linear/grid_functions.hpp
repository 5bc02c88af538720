#pragma once

#include <pliant/backend/backend.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/solver/linear/background_grid.hpp>

// The functions of a grid's nodes, linear along each axis, at the nodes of something finer: a body or a finer grid.
namespace pliant::detail {

/// The function of corner b of a box at local coordinates, 0 to 1 inside.
template <int Dim, class S>
PLIANT_HOST_DEVICE S corner_function(Vector<S, Dim> const& xi, int b) {
  S weight = (b & 1) != 0 ? xi[0] : 1 - xi[0];
  for (int k = 1; k < Dim; ++k) weight = weight * ((b >> k & 1) != 0 ? xi[k] : 1 - xi[k]);
  return weight;
}

/// A local coordinate; exactly 0 or 1 where only rounding tells it from that: a function with next to no value at all
/// unknowns would be one of rounding.
template <class S>
PLIANT_HOST_DEVICE S local_coordinate(S x, S low, builtin_scalar<S> per_spacing) {
  using T = builtin_scalar<S>;
  constexpr T nothing = T(sizeof(T) == 4 ? 1e-3 : 1e-9);
  S const xi = (x - low) * per_spacing, rest = S(1) - xi;
  return select(abs(xi) < S(nothing), S(0), select(abs(rest) < S(nothing), S(1), xi));
}

template <class T, int Dim>
struct GridView {
  static constexpr int corners = power(2, Dim), neighbours = power(3, Dim);
  Index nodes, boxes;
  Index const *corner, *around, *neighbour;  // as in BackgroundGrid
  NodeField<T const, Dim> low;               // (boxes, 4): their lowest corners, m
  T per_spacing[Dim];                        // 1/m
  Index const* box_of;                       // (finer nodes); −1: none
  NodeField<T const, Dim> finer;             // (finer nodes, 4): at rest, m
  Index const *first, *member;               // finer nodes by boxes

  PLIANT_HOST_DEVICE Vector<T, Dim> local(Index finer_node, Index box) const {
    auto xi = finer.at(finer_node);
    auto const origin = low.at(box);
    for (int k = 0; k < Dim; ++k) xi[k] = local_coordinate(xi[k], origin[k], per_spacing[k]);
    return xi;
  }
  /// The sum of the functions with values at nodes, at a finer node.
  PLIANT_HOST_DEVICE Vector<T, Dim> interpolate(NodeField<T const, Dim> values,
                                                Index finer_node) const {
    auto sum = Vector<T, Dim>::zero();
    Index const box = box_of[finer_node];
    if (box < 0) return sum;
    auto const xi = local(finer_node, box);
    for (int b = 0; b < corners; ++b)
      sum = sum + corner_function<Dim>(xi, b) * values.at(corner[corners * box + b]);
    return sum;
  }
  /// visit(finer node, value of the node's function there).
  template <class Visit>
  PLIANT_HOST_DEVICE void for_each_finer(Index node, Visit const& visit) const {
    for (int b = 0; b < corners; ++b) {
      Index const box = around[corners * node + b];
      if (box < 0) continue;
      for (Index j = first[box]; j < first[box + 1]; ++j)
        visit(member[j], corner_function<Dim>(local(member[j], box), b));
    }
  }
};

/// x += P y, at the unknowns of a body or at all nodes of a grid.
template <class T, int Dim>
struct AddInterpolated {
  GridView<T, Dim> grid;
  NodeField<T, Dim> x;
  NodeField<T const, Dim> y;
  T const* mass;  // null: of a grid
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (mass != nullptr && !(mass[i] > T(0))) return;
    auto change = grid.interpolate(y, i);
    if (mass != nullptr)
      for (int k = 0; k < Dim; ++k)
        if (held[i] >> k & 1) change[k] = T(0);
    x.set(i, x.at(i) + change);
  }
};
/// y = Pᵀ (b − q), where b and q are zero at what is no unknown.
template <class T, int Dim>
struct Restrict {
  GridView<T, Dim> grid;
  NodeField<T, Dim> y;
  NodeField<T const, Dim> b, q;
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    auto sum = Vector<T, Dim>::zero();
    grid.for_each_finer(
        node, [&](Index i, T weight) PLIANT_INLINE { sum = sum + weight * (b.at(i) - q.at(i)); });
    y.set(node, sum);
  }
};

/// A grid in the memory of a backend, with the finer nodes that lie in its boxes.
template <Backend B, int Dim>
class GridFunctions {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  GridFunctions() = default;
  /// `rest`: of the finer nodes; `boxes_of` them: −1 for none.
  GridFunctions(B const& backend, BackgroundGrid<Dim> const& grid, Array<T> const& rest,
                std::vector<Index> const& boxes_of)
      : rest_(upload(backend, places(grid, grid.node))),
        low_(upload(backend, places(grid, grid.box))),
        corner_(upload(backend, grid.corner)),
        around_(upload(backend, grid.around)),
        neighbour_(upload(backend, grid.neighbour)),
        box_of_(upload(backend, boxes_of)) {
    auto const boxes = static_cast<Index>(grid.box.size());
    auto keys = boxes_of;  // those of none behind the last
    for (Index& key : keys)
      if (key < 0) key = boxes;
    auto const by_box = group_by_key(keys, boxes + 1);
    first_ = upload(backend, by_box.first);
    member_ = upload(backend, by_box.order);
    view_ = {static_cast<Index>(grid.node.size()),
             boxes,
             corner_.data(),
             around_.data(),
             neighbour_.data(),
             {low_.data()},
             {},
             box_of_.data(),
             {rest.data()},
             first_.data(),
             member_.data()};
    for (int k = 0; k < Dim; ++k)
      view_.per_spacing[k] = static_cast<T>(1 / grid.spacing[static_cast<std::size_t>(k)]);
  }
  Index nodes() const { return view_.nodes; }
  GridView<T, Dim> const& view() const { return view_; }
  Array<T> const& rest() const { return rest_; }                 // (nodes, 4), m
  Array<Index> const& neighbours() const { return neighbour_; }  // as in BackgroundGrid

 private:
  static std::vector<T> places(BackgroundGrid<Dim> const& grid,
                               std::vector<typename BackgroundGrid<Dim>::Place> const& list) {
    std::vector<T> padded(node_stride * list.size(), T(0));
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t k = 0; k < Dim; ++k)
        padded[node_stride * i + k] = static_cast<T>(grid.point_at(list[i])[k]);
    return padded;
  }

  Array<T> rest_, low_;
  Array<Index> corner_, around_, neighbour_, box_of_, first_, member_;
  GridView<T, Dim> view_{};
};

}  // namespace pliant::detail

#pragma once

#include <pliant/element/element.hpp>
#include <pliant/solver/linear/element_columns.hpp>
#include <pliant/solver/linear/sliced_matrix.hpp>

// What matrices of linear elements on the cells of quadratic ones are summed from, and fields of their corners.
namespace pliant::detail {

/// The linear functions of an element's corners.
template <Element E>
struct LinearFunctions {
  static constexpr int count = E::cell::corners;

  template <class F, class Own, class V, class Visit>
  PLIANT_HOST_DEVICE void with_values(Own const&, V const& rest, Visit const& visit) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    using T = builtin_scalar<S>;
    constexpr auto values = linear_at_nodes<E>();
    visit([&](int a, int b) PLIANT_INLINE { return S(static_cast<T>(values(a, b))); });
  }
  /// The function of a corner is no unknown where the corner is held.
  template <class V>
  PLIANT_HOST_DEVICE static auto own_mask(V const& mask, int b, int k) {
    return mask(b, k);
  }
};

/// The elements of one type, their corners by numbers.
template <int Corners>
struct CornerTableView {
  static constexpr int corners = Corners;
  Index elements;
  Index const* corner;          // (corners, elements)
  Index const *first, *member;  // by corners: corners · element + which of its corners
  PLIANT_HOST_DEVICE Index at(Index e, int b) const {
    return corner[static_cast<std::ptrdiff_t>(elements) * b + e];
  }
};

/// The columns of elements' matrices for one direction.
template <class T, int Dim, int Corners>
struct CornerColumns {
  T* data;  // (Corners · Corners · Dim, elements)
  Index elements;
  /// Column `corner` of all elements.
  PLIANT_HOST_DEVICE T* column(int corner) const {
    return data + static_cast<std::ptrdiff_t>(elements) * corner * Corners * Dim;
  }
  PLIANT_HOST_DEVICE T at(Index e, int row, int k, int corner) const {
    return column(corner)[static_cast<std::ptrdiff_t>(elements) * (Dim * row + k) + e];
  }
};

/// Adds them to the row of a corner.
template <class T, int Dim, int Corners>
struct AddCornerColumns {
  SlicedView<T, Dim> a;
  CornerTableView<Corners> table;
  CornerColumns<T, Dim, Corners> columns;
  int direction;
  PLIANT_HOST_DEVICE void operator()(Index row) const {
    for (Index j = table.first[row]; j < table.first[row + 1]; ++j) {
      Index const e = table.member[j] / Corners;
      int const b = table.member[j] % Corners;
      for (int c = 0; c < Corners; ++c) {
        int const slot = a.slot_of(row, table.at(e, c));
        for (int k = 0; k < Dim; ++k) a(row, slot, k, direction) += columns.at(e, b, k, c);
      }
    }
  }
};

/// Adds them to the row of a node of the grid around the corners, each element's by the functions of the box that holds it.
template <class T, int Dim, int Corners>
struct AddBoxColumns {
  StencilView<T, Dim> a;
  GridView<T, Dim> grid;  // whose finer nodes are the corners
  CornerTableView<Corners> table;
  CornerColumns<T, Dim, Corners> columns;
  Index const *first, *member;  // elements by boxes
  int direction;
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    constexpr int ends = power(2, Dim);
    for (int b = 0; b < ends; ++b) {
      Index const box = grid.around[ends * node + b];
      if (box < 0) continue;
      Matrix<T, ends, Dim> sum{};
      for (Index j = first[box]; j < first[box + 1]; ++j) {
        Index const e = member[j];
        Vector<T, Corners> own;
        for (int c = 0; c < Corners; ++c)
          own[c] = corner_function<Dim>(grid.local(table.at(e, c), box), b);
        for (int c = 0; c < Corners; ++c) {
          auto part = Vector<T, Dim>::zero();
          for (int r = 0; r < Corners; ++r)
            for (int k = 0; k < Dim; ++k) part[k] += own[r] * columns.at(e, r, k, c);
          auto const xi = grid.local(table.at(e, c), box);
          for (int end = 0; end < ends; ++end) {
            T const other = corner_function<Dim>(xi, end);
            for (int k = 0; k < Dim; ++k) sum(end, k) += other * part[k];
          }
        }
      }
      for (int end = 0; end < ends; ++end)
        for (int k = 0; k < Dim; ++k)
          a(node, offset_between<Dim>(b, end), k, direction) += sum(end, k);
    }
  }
};

/// A node's share, for one element around it, of a column of the blocks that stand at nodes alone: of added force terms,
/// and masses.
template <class T, int Dim>
struct SetNodalColumn {
  NodeField<T, Dim> column;
  NodeField<T const, Dim> terms;
  T const *share, *mass;
  T stiffness, inertia;
  int direction;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto value = stiffness * terms.at(i);
    value[direction] += inertia * mass[i];
    column.set(i, share[i] * value);
  }
};

/// What corners have of what nodes have.
template <class T, int Dim>
struct TakeCorners {
  Index const* node;  // of corners
  NodeField<T, Dim> to;
  NodeField<T const, Dim> from;
  DirectionMask const* held;  // of corners
  PLIANT_HOST_DEVICE void operator()(Index c) const {
    auto value = from.at(node[c]);
    for (int k = 0; k < Dim; ++k)
      if (held[c] >> k & 1) value[k] = T(0);
    to.set(c, value);
  }
};
/// The inverse.
template <class T, int Dim>
struct PutCorners {
  Index const* node;
  NodeField<T, Dim> to;
  NodeField<T const, Dim> from;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index c) const {
    auto value = from.at(c);
    for (int k = 0; k < Dim; ++k)
      if (held[c] >> k & 1) value[k] = T(0);
    to.set(node[c], value);
  }
};
template <class T>
struct TakeHeldAndMass {
  Index const* node;
  DirectionMask* held;
  T* mass;
  DirectionMask const* held_of_node;
  T const* mass_of_node;
  PLIANT_HOST_DEVICE void operator()(Index c) const {
    held[c] = held_of_node[node[c]];
    mass[c] = mass_of_node[node[c]];
  }
};

}  // namespace pliant::detail

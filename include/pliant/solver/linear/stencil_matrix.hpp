#pragma once

#include <pliant/solver/linear/grid_functions.hpp>
#include <pliant/solver/linear/shifted_tangent.hpp>

namespace pliant::detail {

/// A matrix of Dim × Dim blocks between each node of a grid and its neighbours, in a backend's memory. Entries of
/// 32 nodes lie side by side, as threads of a GPU read them.
template <class T, int Dim>
struct StencilView {
  static constexpr int neighbours = power(3, Dim), entries_per_node = neighbours * Dim * Dim;
  static constexpr int together = 32;
  T* entries;
  Index const* neighbour;  // (nodes, neighbours); −1: none

  static std::size_t size(Index nodes) {
    return static_cast<std::size_t>((nodes + together - 1) / together) * together *
           entries_per_node;
  }
  PLIANT_HOST_DEVICE T& operator()(Index node, int offset, int k, int l) const {
    return entries[(static_cast<std::ptrdiff_t>(node / together) * entries_per_node +
                    (Dim * offset + k) * Dim + l) *
                       together +
                   node % together];
  }
  PLIANT_HOST_DEVICE void add(Index node, int offset, Tensor<T, Dim> const& block) const {
    for (int k = 0; k < Dim; ++k)
      for (int l = 0; l < Dim; ++l) (*this)(node, offset, k, l) += block(k, l);
  }
  PLIANT_HOST_DEVICE Tensor<T, Dim> diagonal(Index node) const {
    return block(node, neighbours / 2);
  }
  PLIANT_HOST_DEVICE Tensor<T, Dim> block(Index node, int offset) const {
    Tensor<T, Dim> a;
    for (int k = 0; k < Dim; ++k)
      for (int l = 0; l < Dim; ++l) a(k, l) = (*this)(node, offset, k, l);
    return a;
  }
};

template <class T, int Dim>
struct ClearStencil {
  StencilView<T, Dim> a;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int o = 0; o < a.neighbours; ++o)
      for (int k = 0; k < Dim; ++k)
        for (int l = 0; l < Dim; ++l) a(i, o, k, l) = T(0);
  }
};

/// y = A x.
template <class T, int Dim>
struct StencilProduct {
  StencilView<T, Dim> a;
  NodeField<T, Dim> y;
  NodeField<T const, Dim> x;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto sum = Vector<T, Dim>::zero();
    for (int o = 0; o < a.neighbours; ++o)
      if (Index const j = a.neighbour[a.neighbours * i + o]; j >= 0)
        sum = sum + a.block(i, o) * x.at(j);
    y.set(i, sum);
  }
};

/// A block of the coarser grid's matrix Pᵀ A P: numbers (node, offset).
template <class T, int Dim>
struct GalerkinBlock {
  static constexpr int neighbours = power(3, Dim);
  StencilView<T, Dim> coarse, fine;
  GridView<T, Dim> grid;  // the coarser one
  PLIANT_HOST_DEVICE void operator()(Index number) const {
    Index const row = number / neighbours;
    int const offset = number % neighbours;
    Index const column = coarse.neighbour[number];
    if (column < 0) return;
    auto sum = Tensor<T, Dim>::zero();
    grid.for_each_finer(row, [&](Index j, T weight) PLIANT_INLINE {
      if (weight == T(0)) return;
      for (int o = 0; o < neighbours; ++o) {
        Index const k = fine.neighbour[neighbours * j + o];
        if (k < 0) continue;
        T const other = value_at(column, k);
        if (other != T(0)) sum = sum + (weight * other) * fine.block(j, o);
      }
    });
    for (int k = 0; k < Dim; ++k)
      for (int l = 0; l < Dim; ++l) coarse(row, offset, k, l) = sum(k, l);
  }
  /// Of the function of a node, at a node of the finer grid.
  PLIANT_HOST_DEVICE T value_at(Index node, Index finer_node) const {
    Index const box = grid.box_of[finer_node];
    for (int b = 0; b < grid.corners; ++b)
      if (grid.corner[grid.corners * box + b] == node)
        return corner_function<Dim>(grid.local(finer_node, box), b);
    return T(0);
  }
};

/// Makes inverse blocks of the diagonal. What has no diagonal is no unknown.
template <class T, int Dim, class View>
struct InvertDiagonal {
  View a;
  NodeField<T, Dim> columns[Dim];
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const own = a.diagonal(i);
    DirectionMask none = 0;
    for (int k = 0; k < Dim; ++k)
      if (!(own(k, k) > T(0))) none = static_cast<DirectionMask>(none | 1 << k);
    auto const inverse = inverse_block(own, none);
    for (int l = 0; l < Dim; ++l) {
      Vector<T, Dim> column;
      for (int k = 0; k < Dim; ++k) column[k] = (inverse(k, l) + inverse(l, k)) / T(2);
      columns[l].set(i, column);
    }
  }
};

}  // namespace pliant::detail

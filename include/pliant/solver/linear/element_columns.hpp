#pragma once

#include <pliant/solver/linear/stencil_matrix.hpp>

// The first matrix of a grid: each element adds its energy of the functions of the one box that holds its middle, continued
// where it reaches out of that. So entries lie between neighbours, and the matrix is positive semi-definite where those
// of the elements are, whatever the mesh; where elements lie within boxes it is Galerkin's.
namespace pliant::detail {

/// Column (corner, direction) of an element's matrix over the corners of its box.
template <class T, int Dim, class Laws>
struct ElementColumn {
  static constexpr bool reads_elements = true;
  static constexpr int counters = 0, corners = power(2, Dim), count = corners * Dim;
  Laws groups;
  ElementField<T const, Dim> low;  // corners of the boxes, m
  T per_spacing[Dim];              // 1/m
  int corner, direction;
  T factor;
  T* out;  // (count, elements)
  Index elements;

  /// `mask`: one at unknowns, zero at what is held, and what slaves have of both.
  template <int G, class Own, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Own const& own, V const& rest, V const& u,
                                   V const& mask) const {
    using F = typename Laws::template formulation<G>;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto const origin = own(low);
    auto const local = [&](int a) PLIANT_INLINE {
      Vector<S, Dim> xi;
      for (int k = 0; k < Dim; ++k)
        xi[k] = local_coordinate<S>(rest(a, k), origin[k], per_spacing[k]);
      return xi;
    };
    auto du = V::zero();
    for (int a = 0; a < F::nodes; ++a)
      for (int k = 0; k < Dim; ++k)
        if (k == direction) du(a, k) = mask(a, k) * corner_function<Dim>(local(a), corner);
    auto const product = [&](auto const& law, auto const&... v)
                             PLIANT_INLINE { return tangent_product<F>(law, v...); };
    auto const df = [&]() PLIANT_INLINE {
      if constexpr (Laws::reads_elements)
        return groups.template apply<G>(product, own, rest, u, du);
      else
        return groups.template apply<G>(product, rest, u, du);
    }();
    Vector<S, count> column{};
    for (int a = 0; a < F::nodes; ++a) {
      auto const xi = local(a);
      for (int b = 0; b < corners; ++b) {
        S const weight = -factor * corner_function<Dim>(xi, b);
        for (int k = 0; k < Dim; ++k)
          column[Dim * b + k] = column[Dim * b + k] + weight * (mask(a, k) * df(a, k));
      }
    }
    return column;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, count> const& column,
                                 Again const&, Tally const&) const {
    for (int k = 0; k < count; ++k) out[static_cast<std::ptrdiff_t>(elements) * k + e] = column[k];
  }
};

/// Adds these columns to the rows of a node.
template <class T, int Dim>
struct AddElementColumns {
  StencilView<T, Dim> a;
  GridView<T, Dim> grid;
  Index const *first, *member;  // elements by boxes
  int corner, direction;
  T const* columns;  // (count, elements)
  Index elements;
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    for (int b = 0; b < grid.corners; ++b) {
      Index const box = grid.around[grid.corners * node + b];
      if (box < 0) continue;
      auto sum = Vector<T, Dim>::zero();
      for (Index j = first[box]; j < first[box + 1]; ++j)
        for (int k = 0; k < Dim; ++k)
          sum[k] += columns[static_cast<std::ptrdiff_t>(elements) * (Dim * b + k) + member[j]];
      int const offset = offset_between<Dim>(b, corner);
      for (int k = 0; k < Dim; ++k) a(node, offset, k, direction) += sum[k];
    }
  }
};

/// Adds what stands at finer nodes alone: masses times `inertia`, and blocks of a diagonal where there are such.
template <class T, int Dim>
struct AddNodalBlocks {
  StencilView<T, Dim> a;
  GridView<T, Dim> grid;
  T const* mass;
  DirectionMask const* held;
  T inertia, stiffness;
  NodeField<T const, Dim> columns[Dim];  // null: none
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    for (int b = 0; b < grid.corners; ++b) {
      Index const box = grid.around[grid.corners * node + b];
      if (box < 0) continue;
      for (Index j = grid.first[box]; j < grid.first[box + 1]; ++j) {
        Index const i = grid.member[j];
        if (!(mass[i] > T(0))) continue;
        auto block = Tensor<T, Dim>::zero();
        for (int l = 0; l < Dim; ++l) {
          if (columns[l].data != nullptr)
            for (int k = 0; k < Dim; ++k) block(k, l) = stiffness * columns[l](i, k);
          block(l, l) += inertia * mass[i];
        }
        for (int l = 0; l < Dim; ++l)
          if (held[i] >> l & 1)
            for (int k = 0; k < Dim; ++k) block(k, l) = block(l, k) = T(0);
        auto const xi = grid.local(i, box);
        T const own = corner_function<Dim>(xi, b);
        for (int c = 0; c < grid.corners; ++c)
          a.add(node, offset_between<Dim>(b, c), (own * corner_function<Dim>(xi, c)) * block);
      }
    }
  }
};

/// One at the unknowns of nodes that have mass, zero at what is held.
template <class T, int Dim>
struct SetMask {
  NodeField<T, Dim> mask;
  T const* mass;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k)
      mask(i, k) = mass[i] > T(0) && (held[i] >> k & 1) == 0 ? T(1) : T(0);
  }
};

}  // namespace pliant::detail

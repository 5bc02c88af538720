#pragma once

#include <pliant/solver/linear/stencil_matrix.hpp>

// The first matrix of a grid: each element adds its energy of the functions of the one box that holds its middle, continued
// where it reaches out of that. So entries lie between neighbours, and the matrix is positive semi-definite where those
// of the elements are, whatever the mesh; where elements lie within boxes it is Galerkin's.
namespace pliant::detail {

/// The functions of the corners of an element's box.
template <class T, int Dim>
struct BoxFunctions {
  static constexpr int count = power(2, Dim);
  ElementField<T const, Dim> low;  // lowest corners of the boxes, m
  T per_spacing[Dim];              // 1/m

  /// Calls visit(value), where value(a, b) is that of function b at node a.
  template <class F, class Own, class V, class Visit>
  PLIANT_HOST_DEVICE void with_values(Own const& own, V const& rest, Visit const& visit) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto const origin = own(low);
    visit([&](int a, int b) PLIANT_INLINE {
      Vector<S, Dim> xi;
      for (int k = 0; k < Dim; ++k)
        xi[k] = local_coordinate<S>(rest(a, k), origin[k], per_spacing[k]);
      return corner_function<Dim>(xi, b);
    });
  }
  /// What a function's share of direction k is multiplied by, besides what `mask` is at nodes.
  template <class V>
  PLIANT_HOST_DEVICE static T own_mask(V const&, int, int) {
    return T(1);
  }
};

/// Column (function, direction) of an element's matrix for coarser functions.
template <class T, class Laws, class Functions>
struct ElementColumn {
  static constexpr bool reads_elements = true;
  static constexpr int dim = Laws::template formulation<0>::dim;
  static constexpr int counters = 0, count = Functions::count * dim;
  Laws groups;
  Functions functions;
  int function, direction;
  T factor;
  T* out;  // (count, elements)
  Index elements;

  /// `mask`: one at unknowns, zero at what is held, and what slaves have of both. `nodal`, if there: what is added to the
  /// element's matrix at nodes, column `direction` of their blocks.
  template <int G, class Own, class V, class... Nodal>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Own const& own, V const& rest, V const& u,
                                   V const& mask, Nodal const&... nodal) const {
    using F = typename Laws::template formulation<G>;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    Vector<S, count> column{};
    functions.template with_values<F>(own, rest, [&](auto const& value) PLIANT_INLINE {
      auto du = V::zero();
      for (int a = 0; a < F::nodes; ++a)
        for (int k = 0; k < dim; ++k)
          if (k == direction) du(a, k) = mask(a, k) * value(a, function);
      auto const product = [&](auto const& law, auto const&... v)
                               PLIANT_INLINE { return tangent_product<F>(law, v...); };
      auto const df = [&]() PLIANT_INLINE {
        if constexpr (Laws::reads_elements)
          return groups.template apply<G>(product, own, rest, u, du);
        else
          return groups.template apply<G>(product, rest, u, du);
      }();
      for (int a = 0; a < F::nodes; ++a) {
        auto image = Vector<S, dim>::zero();
        for (int k = 0; k < dim; ++k) image[k] = -factor * df(a, k);
        for (int l = 0; l < dim; ++l)
          if (l == direction)
            for (int k = 0; k < dim; ++k) ((image[k] = image[k] + nodal(a, k) * du(a, l)), ...);
        for (int b = 0; b < Functions::count; ++b) {
          S const weight = value(a, b);
          for (int k = 0; k < dim; ++k)
            column[dim * b + k] = column[dim * b + k] + weight * (mask(a, k) * image[k]);
        }
      }
    });
    S own_mask = S(0);
    for (int l = 0; l < dim; ++l)
      if (l == direction) own_mask = S(Functions::own_mask(mask, function, l));
    for (int b = 0; b < Functions::count; ++b)
      for (int k = 0; k < dim; ++k)
        column[dim * b + k] = own_mask * S(Functions::own_mask(mask, b, k)) * column[dim * b + k];
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

#pragma once

#include <pliant/force/forces.hpp>
#include <pliant/solver/linear/node_sums.hpp>
#include <pliant/solver/mass_product.hpp>

namespace pliant {

namespace detail {

/// The inverse of a block of the diagonal in the directions that are unknown, zero in the others; of its diagonal
/// alone where it is not positive definite.
template <class T, int Dim>
PLIANT_HOST_DEVICE Tensor<T, Dim> inverse_block(Tensor<T, Dim> a, DirectionMask held) {
  auto inverse = Tensor<T, Dim>::zero();
  Tensor<T, Dim> const given = a;
  bool definite = true;
  auto const known = [held](int k) { return (held >> k & 1) != 0; };
  for (int k = 0; k < Dim; ++k)
    if (known(k)) {
      for (int j = 0; j < Dim; ++j) a(k, j) = a(j, k) = T(0);
      a(k, k) = T(1);
    }
  for (int k = 0; k < Dim; ++k) inverse(k, k) = T(1);
  for (int k = 0; k < Dim; ++k) {  // Gauss and Jordan
    T const pivot = a(k, k);
    definite = definite && pivot > T(1e-6) * given(k, k);
    T const scale = T(1) / pivot;
    for (int j = 0; j < Dim; ++j) {
      a(k, j) = a(k, j) * scale;
      inverse(k, j) = inverse(k, j) * scale;
    }
    for (int i = 0; i < Dim; ++i) {
      if (i == k) continue;
      T const factor = a(i, k);
      for (int j = 0; j < Dim; ++j) {
        a(i, j) = a(i, j) - factor * a(k, j);
        inverse(i, j) = inverse(i, j) - factor * inverse(k, j);
      }
    }
  }
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      if (!definite) inverse(i, j) = i == j && given(i, i) != T(0) ? T(1) / abs(given(i, i)) : T(0);
      if (known(i) || known(j)) inverse(i, j) = T(0);
    }
  return inverse;
}

/// Makes inverse blocks of what the columns hold of the stiffness, times a factor, and of lumped masses.
template <class T, int Dim>
struct InvertBlocks {
  NodeField<T, Dim> columns[Dim];
  T const* mass;
  DirectionMask const* held;
  T stiffness, inertia;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    T const m = mass[i];
    Tensor<T, Dim> a;
    for (int l = 0; l < Dim; ++l) {
      auto const column = columns[l].at(i);
      for (int k = 0; k < Dim; ++k) a(k, l) = stiffness * column[k] + (k == l ? inertia * m : T(0));
    }
    auto const inverse = inverse_block(a, m > T(0) ? held[i] : DirectionMask{0xff});
    for (int l = 0; l < Dim; ++l) {
      Vector<T, Dim> column;
      for (int k = 0; k < Dim; ++k) column[k] = (inverse(k, l) + inverse(l, k)) / T(2);
      columns[l].set(i, column);
    }
  }
};

/// The matrix inertia M + stiffness K(place) + damping K(start) over a body's unknowns, where K = −∂force/∂u, by its
/// products alone; and the inverses of its blocks of a node and a node.
template <class Parts>
class ShiftedTangent {
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Field = typename Parts::Field;
  using ConstField = typename Parts::ConstField;

 public:
  double inertia;
  MassMatrix mass;
  double stiffness;
  ConstField place;  // displacements, m
  double damping;    // may be 0
  ConstField start;

  /// y = A x, zero at what is no unknown; x is zero there, and gets values at slaves. y has scratch rows.
  void apply(Parts const& parts, Field x, Field y) const {
    parts.layout.interpolation.apply(parts.backend, x);
    clear_rows(parts, y);
    ConstField const from{x.data};
    auto const add = [&](double factor, ConstField at) {
      if (factor == 0) return;
      for_each_force_term(parts, [&](auto const& term) {
        term.add_tangent_product(parts.backend, static_cast<T>(-factor), parts.at(at), from, y);
      });
    };
    add(stiffness, place);
    add(damping, start);
    if (inertia != 0) add_mass_product(parts, mass, inertia, from, y);
    parts.layout.interpolation.add_transpose(parts.backend, y);
    keep_unknowns(parts, y);
  }

  /// Puts the inverse blocks into (dim, nodes, 4); `work` has scratch rows. Masses count as lumped.
  void invert_blocks(Parts const& parts, T* blocks, Field work) const {
    InvertBlocks<T, dim> invert{{},
                                parts.layout.mass.data(),
                                parts.layout.held.data(),
                                static_cast<T>(stiffness + damping),
                                static_cast<T>(inertia)};
    Index const n = parts.layout.rows;
    for (int k = 0; k < dim; ++k) {
      invert.columns[k] = column(parts, blocks, k);
      clear_rows(parts, work);
      if (stiffness + damping != 0)
        for_each_force_term(parts, [&](auto const& term) {
          term.add_diagonal(parts.backend, parts.at(place), k, work);
        });
      parts.layout.interpolation.hand_on_magnitudes(parts.backend, work);
      set_sum(parts.backend, n, invert.columns[k], Scaled<T, dim>{1, {work.data}});
    }
    parts.backend.for_each(n, invert);
  }
  /// Column k of all blocks.
  static Field column(Parts const& parts, T* blocks, int k) {
    return {blocks + static_cast<std::ptrdiff_t>(k) * node_stride * parts.layout.rows};
  }
};

}  // namespace detail
}  // namespace pliant

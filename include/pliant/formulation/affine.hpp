#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include <pliant/formulation/mass.hpp>
#include <pliant/math/uncontracted.hpp>

// Elements whose map from the cell is affine (parallelepipeds, straight simplices), what is integrated over them is
// known but for one factor.
namespace pliant {

namespace detail {

/// Corners of a cell whose differences to corner 0 span it, and the inverse of these differences: one per column.
template <int Dim>
struct AffineFrame {
  std::array<int, Dim> corner;
  Tensor<double, Dim> inverse;
};
template <class Cell>
constexpr AffineFrame<Cell::dim> affine_frame() {
  constexpr int dim = Cell::dim;
  for (int a = 1; a < Cell::corners; ++a)
    for (int b = a + 1; b < Cell::corners; ++b)
      for (int c = b + 1; c < Cell::corners + (dim == 2 ? Cell::corners : 0); ++c) {
        AffineFrame<dim> frame{};
        std::array<int, 3> const corners{a, b, c};
        Tensor<double, dim> edges{};
        for (std::size_t j = 0; j < std::size_t{dim}; ++j) {
          frame.corner[j] = corners[j];
          for (int i = 0; i < dim; ++i)
            edges(i, static_cast<int>(j)) = Cell::corner(corners[j])[i] - Cell::corner(0)[i];
        }
        double const det = determinant(edges);
        if (det == 0) continue;
        frame.inverse = 1 / det * transpose(cofactor(edges));
        return frame;
      }
  return {};
}

/// See affine_gradient; false: nothing.
template <Element E, class S>
PLIANT_HOST_DEVICE bool find_affine_gradient(Nodal<E, S> const& rest, Tensor<S, E::dim>& gradient) {
  // Without an initialiser it would be zero in device code (nvcc 13.0).
  static constexpr auto frame = affine_frame<typename E::cell>();
  static constexpr auto places = [] {
    Nodal<E, double> p{};
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) p(a, k) = E::place(a)[k] - E::place(0)[k];
    return p;
  }();
  Tensor<S, E::dim> edges, inverse;
  for (int j = 0; j < E::dim; ++j)
    for (int i = 0; i < E::dim; ++i) {
      edges(i, j) = rest(frame.corner[static_cast<std::size_t>(j)], i) - rest(0, i);
      inverse(i, j) = S(frame.inverse(i, j));
    }
  gradient = edges * inverse;
  auto const lies_within = [&](int a, S const& distance) {
    for (int i = 0; i < E::dim; ++i) {
      S off = rest(a, i) - rest(0, i);
      for (int k = 0; k < E::dim; ++k) off -= gradient(i, k) * S(places(a, k));
      if (!(abs(off) <= distance)) return false;
    }
    return true;
  };
  S size = S(0), farthest = S(0);  // of an edge; from the origin
  for (int j = 0; j < E::dim; ++j)
    for (int i = 0; i < E::dim; ++i) size = max(size, abs(edges(i, j)));
  // Of most elements that are not affine this node tells.
  S const near = S(1e-6) * size;
  if (!lies_within(E::nodes - 1, near)) return false;
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < E::dim; ++i) farthest = max(farthest, abs(rest(a, i)));
  S const most = min(S(8 * std::numeric_limits<double>::epsilon()) * farthest, near);
  for (int a = 1; a < E::nodes; ++a)
    if (!lies_within(a, most)) return false;
  return true;
}

/// The nodal volumes of the element that the cell itself is.
template <Element E>
Vector<double, E::nodes> const& nodal_volumes_of_cell() {
  static auto const of_cell = [] {
    Nodal<E, double> cell;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) cell(a, k) = E::place(a)[k];
    return nodal_volumes<E>(cell);
  }();
  return of_cell;
}

/// host_nodal_volumes on a device too, where `of_cell` has nodal_volumes_of_cell.
template <Element E, class S>
PLIANT_HOST_DEVICE Vector<S, E::nodes> nodal_volumes_by_shape(
    Nodal<E, S> const& rest, Vector<double, E::nodes> const& of_cell) {
  if constexpr (!LinearSimplex<E>) {
    Tensor<S, E::dim> gradient;
    if (find_affine_gradient<E, S>(rest, gradient)) {
      S const factor = determinant(gradient);
      Vector<S, E::nodes> volumes;
      for (int a = 0; a < E::nodes; ++a) volumes[a] = factor * S(of_cell[a]);
      return volumes;
    }
  }
  return nodal_volumes<E>(rest);
}

/// host_nodal_masses on a device too, with the same bits.
template <Element E>
PLIANT_HOST_DEVICE Vector<double, E::nodes> nodal_masses(Nodal<E, double> const& rest,
                                                         double density,
                                                         Vector<double, E::nodes> const& of_cell) {
  using S = Uncontracted;
  Nodal<E, S> x;
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) x(a, k) = rest(a, k);
  auto const volumes = nodal_volumes_by_shape<E, S>(x, of_cell);
  Vector<double, E::nodes> masses;
  for (int a = 0; a < E::nodes; ++a) masses[a] = (S(density) * volumes[a]).value;
  return masses;
}

}  // namespace detail

/// The gradient ∂X_i/∂ξ_k of the map from an element's cell, where it is the same everywhere as far as its
/// coordinates tell: no node is farther from where that puts it than rounding can bring it, nor than a millionth
/// of an edge. Else nothing.
template <Element E>
std::optional<Tensor<double, E::dim>> affine_gradient(Nodal<E, double> const& rest) {
  if constexpr (LinearSimplex<E>) {
    return transpose(Coefficients<E, double>::of(rest).to_corners());
  } else {
    Tensor<double, E::dim> gradient;
    if (!detail::find_affine_gradient<E, double>(rest, gradient)) return {};
    return gradient;
  }
}

/// nodal_volumes, at the cost of one determinant where the map from the cell is affine.
template <Element E>
inline PLIANT_INLINE Vector<double, E::nodes> host_nodal_volumes(Nodal<E, double> const& rest) {
  if constexpr (LinearSimplex<E>)
    return nodal_volumes<E>(rest);
  else
    return detail::nodal_volumes_by_shape<E, double>(rest, detail::nodal_volumes_of_cell<E>());
}

/// The share that each node has of an element's mass, kg, at a density, kg/m³. Nothing is fused, so that whoever adds these up
/// adds the same bits, on a device too. Out of line, as it is large.
template <Element E>
[[gnu::noinline]] Vector<double, E::nodes> host_nodal_masses(Nodal<E, double> const& rest,
                                                             double density) {
  if constexpr (LinearSimplex<E>)
    return detail::nodal_masses<E>(rest, density, {});
  else
    return detail::nodal_masses<E>(rest, density, detail::nodal_volumes_of_cell<E>());
}

}  // namespace pliant

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <pliant/formulation/mass.hpp>

// Elements whose map from the cell is affine (parallelepipeds, straight simplices), on the host: what is integrated over
// them is known but for one factor.
namespace pliant {

namespace detail {

/// Corners of a cell whose differences to corner 0 span it, and the inverse of these differences: one per column.
template <class Cell>
struct AffineFrame {
  std::array<int, Cell::dim> corner{};
  Tensor<double, Cell::dim> inverse{};

  constexpr AffineFrame() {
    for (int a = 1; a < Cell::corners; ++a)
      for (int b = a + 1; b < Cell::corners; ++b)
        for (int c = b + 1; c < Cell::corners + (Cell::dim == 2 ? Cell::corners : 0); ++c)
          if (take({a, b, c})) return;
  }

 private:
  constexpr bool take(std::array<int, 3> const& corners) {
    Tensor<double, Cell::dim> edges{};
    for (int j = 0; j < Cell::dim; ++j) {
      corner[static_cast<std::size_t>(j)] = corners[static_cast<std::size_t>(j)];
      for (int i = 0; i < Cell::dim; ++i)
        edges(i, j) = Cell::corner(corners[static_cast<std::size_t>(j)])[i] - Cell::corner(0)[i];
    }
    double const det = determinant(edges);
    if (det == 0) return false;
    inverse = 1 / det * transpose(cofactor(edges));
    return true;
  }
};

template <Element E>
std::optional<Tensor<double, E::dim>> affine_gradient_by_places(Nodal<E, double> const& rest) {
  static constexpr AffineFrame<typename E::cell> frame;
  static constexpr auto places = [] {
    Nodal<E, double> p{};
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) p(a, k) = E::place(a)[k] - E::place(0)[k];
    return p;
  }();
  Tensor<double, E::dim> edges;
  for (int j = 0; j < E::dim; ++j)
    for (int i = 0; i < E::dim; ++i)
      edges(i, j) = rest(frame.corner[static_cast<std::size_t>(j)], i) - rest(0, i);
  auto const gradient = edges * frame.inverse;
  auto const lies_within = [&](int a, double distance) {
    for (int i = 0; i < E::dim; ++i) {
      double off = rest(a, i) - rest(0, i);
      for (int k = 0; k < E::dim; ++k) off -= gradient(i, k) * places(a, k);
      if (!(std::abs(off) <= distance)) return false;
    }
    return true;
  };
  double size = 0, farthest = 0;  // of an edge; from the origin
  for (int j = 0; j < E::dim; ++j)
    for (int i = 0; i < E::dim; ++i) size = std::max(size, std::abs(edges(i, j)));
  // Of most elements that are not affine this node tells.
  if (!lies_within(E::nodes - 1, 1e-6 * size)) return {};
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < E::dim; ++i) farthest = std::max(farthest, std::abs(rest(a, i)));
  double const most = std::min(8 * std::numeric_limits<double>::epsilon() * farthest, 1e-6 * size);
  for (int a = 1; a < E::nodes; ++a)
    if (!lies_within(a, most)) return {};
  return gradient;
}

template <Element E>
Vector<double, E::nodes> nodal_volumes_by_shape(Nodal<E, double> const& rest) {
  static auto const of_cell = [] {
    Nodal<E, double> cell;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) cell(a, k) = E::place(a)[k];
    return nodal_volumes<E>(cell);
  }();
  if (auto const gradient = affine_gradient_by_places<E>(rest))
    return determinant(*gradient) * of_cell;
  return nodal_volumes<E>(rest);
}

}  // namespace detail

/// The gradient ∂X_i/∂ξ_k of the map from an element's cell, where it is the same everywhere as far as its
/// coordinates tell: no node is farther from where that puts it than rounding can bring it, nor than a millionth
/// of an edge. Else nothing.
template <Element E>
std::optional<Tensor<double, E::dim>> affine_gradient(Nodal<E, double> const& rest) {
  if constexpr (LinearSimplex<E>)
    return transpose(Coefficients<E, double>::of(rest).to_corners());
  else
    return detail::affine_gradient_by_places<E>(rest);
}

/// nodal_volumes, at the cost of one determinant where the map from the cell is affine.
template <Element E>
inline PLIANT_INLINE Vector<double, E::nodes> host_nodal_volumes(Nodal<E, double> const& rest) {
  if constexpr (LinearSimplex<E>)
    return nodal_volumes<E>(rest);
  else
    return detail::nodal_volumes_by_shape<E>(rest);
}

/// The share that each node has of an element's mass, kg, at a density, kg/m³. Out of line, so that whoever adds these up adds
/// the same bits, whatever a compiler fuses where it inlines.
template <Element E>
[[gnu::noinline]] Vector<double, E::nodes> host_nodal_masses(Nodal<E, double> const& rest,
                                                             double density) {
  return density * host_nodal_volumes<E>(rest);
}

}  // namespace pliant

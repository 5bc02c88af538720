#pragma once

#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include <pliant/element/linear.hpp>
#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/element/quadratic_tensor.hpp>
#include <pliant/math/short_list.hpp>
#include <pliant/topology/tree_cell.hpp>

// Elements by the cell they are on, and their shape functions.
namespace pliant {

/// Which nodes the elements of a type have.
template <Element E>
inline constexpr CellNodes nodes_on_cell =
    E::degree == 1                                                 ? CellNodes::corners
    : TensorCell<typename E::cell> && E::lumping == Lumping::nodal ? CellNodes::all
                                                                   : CellNodes::edges;
namespace detail {

/// The weights of an element's nodes.
using ShapeWeights = ShortList<std::pair<Index, double>, 27>;

template <Element E>
PLIANT_HOST_DEVICE ShapeWeights shape_weights(CellNodeList const& nodes,
                                              std::array<double, 3> const& place) {
  Vector<double, E::dim> xi;
  for (int k = 0; k < E::dim; ++k) xi[k] = place[static_cast<std::size_t>(k)];
  auto const shape = E::shape(xi);
  ShapeWeights list;
  for (int a = 0; a < E::nodes; ++a)
    if (shape[a] != 0) list.push_back({nodes[static_cast<std::size_t>(a)], shape[a]});
  return list;
}
/// The weights of an element's nodes in the value at a place on its cell, in Dim dimensions; dyadic numbers, without
/// rounding, so that they are the same from all elements around.
template <int Dim>
PLIANT_HOST_DEVICE ShapeWeights shape_weights(CellKind kind, CellNodes has,
                                              CellNodeList const& nodes,
                                              std::array<double, 3> const& place) {
  auto const choose = [&]<Element Linear, Element Edges, Element All>(
                          std::type_identity<std::tuple<Linear, Edges, All>>) {
    if (has == CellNodes::corners) return shape_weights<Linear>(nodes, place);
    if (has == CellNodes::edges) return shape_weights<Edges>(nodes, place);
    return shape_weights<All>(nodes, place);
  };
  switch (kind) {
    case CellKind::triangle:
      return choose(std::type_identity<std::tuple<Tri3, Tri6, Tri6>>{});
    case CellKind::quadrilateral:
      return choose(std::type_identity<std::tuple<Quad4, Quad8, Quad9>>{});
    case CellKind::tetrahedron:
      return choose(std::type_identity<std::tuple<Tet4, Tet10, Tet10>>{});
    case CellKind::hexahedron:
      return choose(std::type_identity<std::tuple<Hex8, Hex20, Hex27>>{});
    case CellKind::wedge:
      return shape_weights<Wedge6>(nodes, place);
    case CellKind::pyramid:
      break;
  }
  return shape_weights<Pyramid5>(nodes, place);
}

}  // namespace detail
}  // namespace pliant

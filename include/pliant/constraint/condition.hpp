#pragma once

#include <functional>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant {

/// Bits of the directions in which a node does not move freely.
using DirectionMask = std::uint8_t;
template <int Dim>
inline constexpr DirectionMask all_directions = (1u << Dim) - 1;

/// A prescribed displacement as a function of time: s → m.
template <int Dim>
using Motion = std::function<Point<Dim>(double)>;

/// What a body prescribes at facets or at nodes. A condition on facets is inherited by their
/// children when the mesh is refined; one on nodes stays with these nodes.
template <int Dim>
struct Condition {
  std::vector<Facet<Dim>> facets;
  std::vector<Index> nodes;  // the user's numbers, those of the facets included
  DirectionMask directions;
  Motion<Dim> motion;  // empty: held where it is
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/topology/hierarchy.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

namespace detail {

/// Calls visit(side) for the sides of a cell that are facets, by their numbers: in the plane its edges.
template <int Dim, class Visit>
PLIANT_HOST_DEVICE void visit_facets(TreeCell const& cell, Visit const& visit) {
  auto const& p = cell.pattern();
  if constexpr (Dim == 2) {
    for (std::size_t e = 0; e < static_cast<std::size_t>(p.edges); ++e) visit(cell.edges[e]);
  } else {
    for (std::size_t s = 0; s < static_cast<std::size_t>(p.sides); ++s) visit(cell.sides[s]);
  }
}

/// Parts of facets that were divided are held as these are. A call for each refined cell.
template <int Dim>
struct InheritHeld {
  TreeView tree;
  CellSplit const* cells;
  DirectionMask* of_side;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    visit_facets<Dim>(tree.cells[static_cast<std::size_t>(cells[r].cell)], [&](Index side) {
      DirectionMask const mask = of_side[side];
      if (mask == 0) return;
      auto const i = static_cast<std::size_t>(side);
      if constexpr (Dim == 2) {
        for (Index k = 0; k < 2; ++k) of_side[tree.edges[i].first_half + k] = mask;
      } else {
        for (Index k = 0; k < 4; ++k) of_side[tree.sides[i].first_child + k] = mask;
      }
    });
  }
};
/// Holds the nodes between the corners of divided facets that are held, in one direction: all that is written is the same.
template <int Dim>
struct HoldNodesBetween {
  TreeView tree;
  CellSplit const* cells;
  DirectionMask const* of_side;
  DirectionMask direction;
  Index const* of_node;
  DirectionMask* held;  // by row

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    visit_facets<Dim>(tree.cells[static_cast<std::size_t>(cells[r].cell)], [&](Index side) {
      if ((of_side[side] & direction) == 0) return;
      if constexpr (Dim == 2) {
        hold(tree.edges[static_cast<std::size_t>(side)].middle);
      } else {
        auto const& own = tree.sides[static_cast<std::size_t>(side)];
        hold(own.centre);
        for (std::size_t e = 0; e < own.corners(); ++e)
          hold(tree.edges[static_cast<std::size_t>(own.edges[e])].middle);
      }
    });
  }

 private:
  PLIANT_HOST_DEVICE void hold(Index node) const {
    if (node < 0) return;
    auto& own = held[of_node[node]];
    own = static_cast<DirectionMask>(own | direction);
  }
};

}  // namespace detail

/// The facets of linear elements that conditions hold, as sides of a tree, in a backend's memory.
template <int Dim, Backend B>
class HeldSidesOn {
 public:
  /// Finds those of conditions. `tree`: as it is in the backend's memory. Throws Error for a facet that is no side of it.
  void set(B const& backend, Hierarchy<Dim> const& tree,
           std::vector<Condition<Dim>> const& conditions) {
    std::map<std::vector<Index>, DirectionMask> known;
    std::vector<char> is_corner(tree.points().size(), 0);
    for (auto const& condition : conditions)
      for (auto const& facet : condition.facets) {
        known[sorted(facet)] |= condition.directions;
        for (Index node : facet) is_corner[static_cast<std::size_t>(node)] = 1;
      }
    any_ = !known.empty();
    if (!any_) return;
    std::size_t found = 0;
    auto const mask_of = [&](auto const& nodes) {
      for (Index node : nodes)
        if (node >= 0 && is_corner[static_cast<std::size_t>(node)] == 0) return DirectionMask{0};
      auto const own = known.find(sorted(nodes));
      found += own != known.end();
      return own == known.end() ? DirectionMask{0} : own->second;
    };
    std::vector<DirectionMask> masks;
    if constexpr (Dim == 2) {
      for (auto const& edge : tree.tree().edges()) masks.push_back(mask_of(edge.nodes));
    } else {
      for (auto const& side : tree.tree().sides()) masks.push_back(mask_of(side.nodes));
    }
    if (found < known.size())
      throw Error("refine: of ", known.size(), " facets that conditions hold, ",
                  known.size() - found, " are no sides of elements; give such");
    of_side_ = upload(backend, masks);
    count_ = masks.size();
  }

  /// Holds the parts of facets that a refinement divided, and their nodes. `held`: directions by row.
  void refine(B const& backend, TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined,
              Index const* of_node, DirectionMask* held) {
    if (!any_) return;
    auto const sizes = tree.sizes();
    auto const now = static_cast<std::size_t>(Dim == 2 ? sizes.edges : sizes.sides);
    detail::grow_keeping(backend, of_side_, count_, now);
    count_ = now;
    backend.for_each(refined.leaves,
                     detail::InheritHeld<Dim>{tree.view(), refined.cells, of_side_.data()});
    for (int k = 0; k < Dim; ++k)
      backend.for_each(refined.leaves, detail::HoldNodesBetween<Dim>{
                                           tree.view(), refined.cells, of_side_.data(),
                                           static_cast<DirectionMask>(1 << k), of_node, held});
  }

 private:
  template <class Nodes>
  static std::vector<Index> sorted(Nodes const& nodes) {
    std::vector<Index> list(nodes.begin(), nodes.end());
    std::erase_if(list, [](Index node) { return node < 0; });
    std::ranges::sort(list);
    return list;
  }

  typename B::template Array<DirectionMask> of_side_;
  std::size_t count_ = 0;  // of these
  bool any_ = false;
};

}  // namespace pliant

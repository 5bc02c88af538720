#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/known_facets.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// The sides of a tree's cells, in the plane their edges, as facets of the mesh: those of its boundary, and known ones inside.
/// Refers to the tree.
template <int Dim>
class TreeFacets {
 public:
  explicit TreeFacets(CellTree<Dim> const& tree, KnownFacets<Dim> known = {})
      : tree_(tree), known_(std::move(known)) {}

  /// The sides of leaves that are whole, with the nodes that they have now.
  [[nodiscard]] std::vector<DividedFacet<Dim>> whole(std::vector<Index> const& leaves) const {
    std::vector<DividedFacet<Dim>> facets;
    for (Index const s : whole_sides_of(leaves)) facets.push_back({facet_of(s), {facet_of(s)}});
    return facets;
  }
  /// These sides, by their numbers: each once, ascending.
  [[nodiscard]] std::vector<Index> whole_sides_of(std::vector<Index> const& cells) const {
    auto sides = Dim == 2 ? tree_.edges_of(cells) : tree_.sides_of(cells);
    std::erase_if(sides, [&](Index s) { return first_part(s) >= 0; });
    leave_unknown_out(sides);
    return sides;
  }
  /// The sides of refined cells that have no other refined cell.
  [[nodiscard]] std::vector<Index> sides_of_no_other(std::vector<Index> const& cells) const {
    auto all = sides_of(cells);
    leave_unknown_out(all);
    auto const count = Dim == 2 ? tree_.edges().size() : tree_.sides().size();
    std::vector<bool> once(count, false), twice(count, false);
    for (Index const s : all) (once[at(s)] ? twice : once)[at(s)] = true;
    all = detail::each_once(std::move(all), count);
    std::erase_if(all, [&](Index s) { return (twice[at(s)] ? 2 : 1) != refined_cells_at(s); });
    return all;
  }
  /// Divided sides and their parts.
  [[nodiscard]] std::vector<DividedFacet<Dim>> divided(std::vector<Index> const& sides) const {
    std::vector<DividedFacet<Dim>> facets(sides.size());
    detail::for_each_on_host(static_cast<Index>(sides.size()), 1024,
                             [&](Index k) { facets[at(k)] = divided(sides[at(k)]); });
    return facets;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  void leave_unknown_out(std::vector<Index>& sides) const {
    if (!known_.tells_apart(sides.size())) return;
    auto const corners = known_.corners(tree_.node_count());
    auto const has_known_corners = [&](Index s) {
      return std::ranges::all_of(nodes_at(s),
                                 [&](Index node) { return node < 0 || corners[at(node)]; });
    };
    std::erase_if(sides, [&](Index s) {
      if (is_outside(s)) return false;
      Index const first = first_part(s);
      if (first < 0) return !has_known_corners(s);
      for (Index part = first; part < first + (Dim == 2 ? 2 : 4); ++part)
        if (has_known_corners(part)) return false;
      return true;
    });
  }
  auto nodes_at(Index s) const {
    if constexpr (Dim == 2)
      return tree_.edges()[at(s)].nodes;
    else
      return tree_.lists().view().corners_of(tree_.sides()[at(s)]);
  }
  /// Whether a side has a cell on one side only.
  bool is_outside(Index s) const {
    if constexpr (Dim == 2) {
      auto const& at_edge = tree_.edges()[at(s)].cells;
      return at_edge.leaves() + at_edge.refined() < 2;
    }
    auto const& cells = tree_.sides()[at(s)].cells;
    return cells[0] < 0 || cells[1] < 0;
  }
  DividedFacet<Dim> divided(Index s) const {
    DividedFacet<Dim> facet{facet_of(s), {}};
    Index const first = first_part(s);
    for (Index part = first; part < first + (Dim == 2 ? 2 : 4); ++part)
      facet.parts.push_back(facet_of(part));
    return facet;
  }
  Facet<Dim> facet_of(Index s) const {
    Facet<Dim> facet;
    auto const& edges = tree_.edges();
    auto const has = tree_.lists().view().template nodes_of_facet<Dim>(s);
    if constexpr (Dim == 2) {
      auto const& edge = edges[at(s)];
      for (Index node : edge.nodes) facet.push_back(node);
      if (has != CellNodes::corners) facet.push_back(edge.middle);
    } else {
      auto const& side = tree_.sides()[at(s)];
      for (std::size_t k = 0; k < side.corners(); ++k) facet.push_back(tree_.corner_of(side, k));
      if (has == CellNodes::corners) return facet;
      for (std::size_t k = 0; k < side.corners(); ++k)
        facet.push_back(edges[at(side.edges[k])].middle);
      if (has == CellNodes::all && side.corners() == 4) facet.push_back(side.centre);
    }
    return facet;
  }
  /// Of the parts of a side; −1 while it is whole.
  Index first_part(Index s) const {
    return Dim == 2 ? tree_.edges()[at(s)].first_half : tree_.sides()[at(s)].first_child;
  }
  /// The sides of cells, in the plane their edges: as often as cells have them.
  std::vector<Index> sides_of(std::vector<Index> const& cells) const {
    std::vector<Index> list;
    for (Index const c : cells) {
      auto const own = tree_.row(c);
      auto const& p = tree_[c].pattern();
      for (std::size_t s = 0; s < at(Dim == 2 ? p.edges : p.sides); ++s)
        list.push_back(Dim == 2 ? own.edges[s] : own.sides[s]);
    }
    return list;
  }
  int refined_cells_at(Index s) const {
    if constexpr (Dim == 2) return tree_.edges()[at(s)].cells.refined();
    int count = 0;
    for (Index c : tree_.sides()[at(s)].cells) count += c >= 0 && !tree_.is_leaf(c);
    return count;
  }

  CellTree<Dim> const& tree_;
  KnownFacets<Dim> known_;
};

}  // namespace pliant

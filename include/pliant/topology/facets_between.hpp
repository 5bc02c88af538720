#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/facet_table.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant {

/// Takes facets of one tree over to another one of the same initial mesh, whatever changes lie between: where a facet is
/// divided there, come its parts, and where it was merged, the whole, once. Refers to the trees.
template <int Dim>
class FacetsBetween {
 public:
  using Facets = std::vector<Facet<Dim>>;

  /// `lists`: all facets that are asked for, of the first tree.
  FacetsBetween(TreeLists const& before, TreeLists const& now,
                std::vector<Facets const*> const& lists)
      : before_(before), now_(now) {
    std::vector<bool> is_corner(at(before.nodes), false);
    for (auto const* list : lists)
      for (auto const& facet : *list)
        for (std::size_t k = 0; k < facet.corners(); ++k) is_corner[at(facet[k])] = true;
    std::vector<Index> found;
    for (Index s = 0; s < count(before); ++s) {
      auto const nodes = nodes_at(before, s);
      if (std::ranges::all_of(nodes, [&](Index node) { return node < 0 || is_corner[at(node)]; }))
        found.push_back(s);
    }
    sides_ = FacetTable<Dim>(found.size());
    for (Index const s : found) sides_.add(facet_of(nodes_at(before, s), 0, false), at(s));
  }

  /// Facets of one of the lists, in the order of these, each with its parts in the order of its corners. A facet runs round as
  /// it did, or as the part of it that comes first. Nothing where one lies inside of a cell that was divided: there is no such
  /// facet in the initial mesh, of which it would be a part.
  [[nodiscard]] std::optional<Facets> carry(Facets const& facets) const {
    Facets carried;
    carried.reserve(facets.size());
    std::unordered_set<Index> merged;  // sides of which parts are listed: to come once
    for (auto const& facet : facets) {
      auto const found = sides_.find(facet);
      if (!found) return std::nullopt;
      auto side = static_cast<Index>(*found);
      auto const [start, backwards] = turn_of(nodes_at(before_, side), facet);
      std::vector<Index> path;  // from the initial side, the last first
      for (; side >= initial(); side = parent_of(side)) {
        if (parent_of(side) < 0) return std::nullopt;
        path.push_back(side - first_part(before_, parent_of(side)));
      }
      for (; !path.empty() && first_part(now_, side) >= 0; path.pop_back())
        side = first_part(now_, side) + path.back();
      if (path.empty())
        add(side, start, backwards, carried);
      else if (merged.insert(side).second)
        add(side, first_corner(backwards), backwards, carried);
    }
    return carried;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index count(TreeLists const& of) {
    return static_cast<Index>(Dim == 2 ? of.edges.size() : of.sides.size());
  }
  static auto nodes_at(TreeLists const& of, Index side) {
    if constexpr (Dim == 2)
      return of.edges[at(side)].nodes;
    else
      return of.view().corners_of(of.sides[at(side)]);
  }
  /// Negative: it has none.
  static Index first_part(TreeLists const& of, Index side) {
    return Dim == 2 ? of.edges[at(side)].first_half : of.sides[at(side)].first_child;
  }
  [[nodiscard]] Index initial() const {
    return Dim == 2 ? before_.initial.edges : before_.initial.sides;
  }
  [[nodiscard]] Index parent_of(Index side) const {
    return Dim == 2 ? before_.edges[at(side)].parent() : before_.sides[at(side)].parent;
  }
  static std::size_t corners_of(auto const& nodes) { return nodes.back() < 0 ? 3 : nodes.size(); }
  /// Where a facet begins that the first corner of its side tells apart: in the plane it ends there if it runs backwards.
  static std::size_t first_corner(bool backwards) { return Dim == 2 && backwards ? 1 : 0; }
  /// The corners of a side from one of them on, round as it runs or backwards.
  static Facet<Dim> facet_of(auto const& nodes, std::size_t start, bool backwards) {
    auto const n = corners_of(nodes);
    Facet<Dim> facet;
    for (std::size_t k = 0; k < n; ++k)
      facet.push_back(nodes[(backwards ? start + n - k : start + k) % n]);
    return facet;
  }
  /// The same of the tree of now, with nodes between them.
  [[nodiscard]] Facet<Dim> facet_now(Index side, std::size_t start, bool backwards) const {
    auto const nodes = nodes_at(now_, side);
    auto const n = corners_of(nodes);
    auto facet = facet_of(nodes, start, backwards);
    auto const has = now_.view().template nodes_of_facet<Dim>(side);
    if (has == CellNodes::corners) return facet;
    if constexpr (Dim == 2) {
      facet.push_back(now_.edges[at(side)].middle);
    } else {
      auto const& own = now_.sides[at(side)];
      for (std::size_t k = 0; k < n; ++k) {
        auto const edge = (backwards ? start + 2 * n - 1 - k : start + k) % n;
        facet.push_back(now_.edges[at(own.edges[edge])].middle);
      }
      if (has == CellNodes::all && n == 4) facet.push_back(own.centre);
    }
    return facet;
  }
  /// At which corner of a side a facet with the same corners begins, and whether it runs round backwards.
  static std::pair<std::size_t, bool> turn_of(auto const& nodes, Facet<Dim> const& facet) {
    auto const n = corners_of(nodes);
    std::size_t start = 0;
    while (nodes[start] != facet[0]) ++start;
    return {start, Dim == 2 ? start != 0 : nodes[(start + 1) % n] != facet[1]};
  }
  /// Adds a side, or its parts.
  void add(Index side, std::size_t start, bool backwards, Facets& carried) const {
    auto const& nodes = nodes_at(now_, side);
    auto const n = corners_of(nodes);
    Index const first = first_part(now_, side);
    if (first < 0) {
      carried.push_back(facet_now(side, start, backwards));
      return;
    }
    // Part k is at corner k, where it begins; in the middle of a triangle is another one.
    for (std::size_t k = 0; k < n; ++k) {
      auto const corner = (backwards ? start + n - k : start + k) % n;
      add(first + static_cast<Index>(corner), first_corner(backwards), backwards, carried);
    }
    if (n == 3) add(first + 3, 0, backwards, carried);
  }

  TreeLists const &before_, &now_;
  FacetTable<Dim> sides_;
};

}  // namespace pliant

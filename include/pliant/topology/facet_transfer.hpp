#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/error.hpp>
#include <pliant/math/short_list.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/mesh/sides.hpp>
#include <pliant/topology/facet_table.hpp>
#include <pliant/topology/number_map.hpp>

namespace pliant {

/// A facet of the boundary and the parts into which it is divided: part k at its corner k, then that in the
/// middle of a triangle. Parts run round as the whole does, in 3D from that corner. One part: the facet stays, with
/// other nodes between its corners.
template <int Dim>
struct DividedFacet {
  Facet<Dim> whole;
  ShortList<Facet<Dim>, 4> parts;
};

/// What becomes of facets of the boundary when a mesh changes.
template <int Dim>
class FacetTransfer {
 public:
  FacetTransfer() = default;
  /// `divided` by new numbers of nodes, `merged` by old ones.
  FacetTransfer(std::vector<DividedFacet<Dim>> divided, std::vector<DividedFacet<Dim>> merged)
      : divided_(std::move(divided)), merged_(std::move(merged)) {
    whole_ = FacetTable<Dim>(divided_.size());
    for (std::size_t i = 0; i < divided_.size(); ++i) whole_.add(divided_[i].whole, i);
    std::size_t parts = 0;
    for (auto const& facet : merged_) parts += facet.parts.size();
    parts_ = FacetTable<Dim>(parts);
    for (std::size_t i = 0; i < merged_.size(); ++i)
      for (auto const& part : merged_[i].parts) parts_.add(part, i);
  }

  /// See Transfer::changed_facets. `numbers`: of nodes, by the old one.
  std::optional<std::vector<Facet<Dim>>> carry(std::vector<Facet<Dim>> const& facets,
                                               NumberMap const& numbers) const {
    auto const number_of = [&](Index node) { return numbers[node]; };
    auto const renumbered = [&](Facet<Dim> facet) {
      for (Index& node : facet) node = number_of(node);
      return facet;
    };
    auto const keeps_number = [&](Index node) { return number_of(node) == node; };
    auto const stays = [&](Facet<Dim> const& facet) {
      return !parts_.may_have(facet) && !whole_.may_have(facet) &&
             (numbers.keeps_all() || std::ranges::all_of(facet, keeps_number));
    };
    auto facet = std::ranges::find_if_not(facets, stays);
    if (facet == facets.end()) return std::nullopt;
    std::vector<Facet<Dim>> carried;
    carried.reserve(facets.size() + 3 * divided_.size());
    carried.assign(facets.begin(), facet);
    std::vector<std::size_t> listed(merged_.size(), 0);  // parts of each
    while (facet != facets.end()) {
      auto const whole = parts_.find(*facet);
      if (!whole)
        add_parts(renumbered(*facet), carried);
      else if (listed[*whole]++ == 0)
        add_parts(renumbered(whole_of(merged_[*whole], *facet)), carried);
      auto const next = std::find_if_not(++facet, facets.end(), stays);
      carried.insert(carried.end(), facet, next);
      facet = next;
    }
    check_all_are_listed(listed);
    return carried;
  }
  /// See Transfer::cut_facets.
  std::vector<Facet<Dim>> cut(std::vector<Facet<Dim>> const& facets) const {
    if (merged_.empty()) return {};
    std::vector<std::size_t> listed(merged_.size(), 0);
    for (auto const& facet : facets)
      if (auto const whole = parts_.find(facet)) ++listed[*whole];
    return cut_of(listed);
  }

 private:
  /// All parts of the facets of which some are listed, but not all. `listed`: how many are, by the whole.
  std::vector<Facet<Dim>> cut_of(std::vector<std::size_t> const& listed) const {
    std::vector<Facet<Dim>> found;
    for (std::size_t whole = 0; whole < listed.size(); ++whole)
      if (auto const& parts = merged_[whole].parts;
          listed[whole] > 0 && listed[whole] < parts.size())
        found.insert(found.end(), parts.begin(), parts.end());
    return found;
  }
  void check_all_are_listed(std::vector<std::size_t> const& listed) const {
    auto const missing = cut_of(listed);
    if (missing.empty()) return;
    throw Error(
        "transfer: of the ", missing.size(), " facets that were merged, the one with the nodes ",
        missing[0][0], " and ", missing[0][1],
        " among them, not all are listed; list all, or keep the elements there from being merged");
  }
  /// A facet, or the same the other way round: in 2D from its other end, in 3D from the same corner.
  static Facet<Dim> turned(Facet<Dim> const& facet, bool backwards) {
    if (!backwards) return facet;
    auto const n = facet.corners();
    Facet<Dim> other = facet;
    if constexpr (Dim == 2) {
      std::swap(other.begin()[0], other.begin()[1]);
    } else {
      std::reverse(other.begin() + 1, other.begin() + n);
      if (facet.size() >= 2 * n) std::reverse(other.begin() + n, other.begin() + 2 * n);
    }
    return other;
  }
  /// The whole of which `part` is one, running round as that does.
  static Facet<Dim> whole_of(DividedFacet<Dim> const& divided, Facet<Dim> const& part) {
    for (auto const& own : divided.parts)
      if (mesh::key_of(own) == mesh::key_of(part))
        return turned(divided.whole, runs_backwards(own, part));
    return divided.whole;
  }
  /// Whether two facets with the same corners run round in opposite directions.
  static bool runs_backwards(Facet<Dim> const& one, Facet<Dim> const& other) {
    auto const n = one.corners();
    std::size_t at = 0;
    while (other[at] != one[0]) ++at;
    return Dim == 2 ? at != 0 : other[(at + 1) % n] != one[1];
  }
  void add_parts(Facet<Dim> const& facet, std::vector<Facet<Dim>>& parts) const {
    auto const found = whole_.find(facet);
    if (!found) {
      parts.push_back(facet);
      return;
    }
    auto const& [whole, own] = divided_[*found];
    bool const backwards = runs_backwards(whole, facet);
    if (own.size() == 1) {
      parts.push_back(turned(own[0], backwards));
      return;
    }
    for (std::size_t k = 0; k < facet.corners(); ++k) {
      std::size_t corner = 0;
      while (whole[corner] != facet[k]) ++corner;
      add_parts(turned(own[corner], backwards), parts);
    }
    if (own.size() > facet.corners()) add_parts(turned(own.back(), backwards), parts);
  }

  std::vector<DividedFacet<Dim>> divided_, merged_;
  FacetTable<Dim> whole_, parts_;  // by wholes that are divided, by parts that are merged
};

}  // namespace pliant

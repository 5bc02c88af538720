#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/number_map.hpp>

namespace pliant {

/// Facets inside a mesh for which somebody may ask after a change, beside those of its boundary. Refers to what it is made of.
template <int Dim>
class KnownFacets {
 public:
  /// All.
  KnownFacets() = default;
  /// Those of some lists, by the numbers of nodes before a change.
  explicit KnownFacets(std::vector<std::vector<Facet<Dim>> const*> lists)
      : lists_(std::move(lists)), all_(false) {}
  /// The same by other numbers of nodes.
  [[nodiscard]] KnownFacets renumbered(NumberMap const& nodes) const {
    auto other = *this;
    other.nodes_ = &nodes;
    return other;
  }

  /// Of these many sides it is worth to leave out those that nobody asks for.
  [[nodiscard]] bool tells_apart(std::size_t sides) const { return !all_ && sides > 4096; }
  /// By the node: whether it is a corner of one.
  [[nodiscard]] std::vector<bool> corners(Index nodes) const {
    std::vector<bool> found(static_cast<std::size_t>(nodes), false);
    for (auto const* list : lists_)
      for (auto const& facet : *list)
        for (std::size_t k = 0; k < facet.corners(); ++k) {
          Index const now = nodes_ == nullptr ? facet[k] : (*nodes_)[facet[k]];
          if (now >= 0) found[static_cast<std::size_t>(now)] = true;
        }
    return found;
  }

 private:
  std::vector<std::vector<Facet<Dim>> const*> lists_;
  NumberMap const* nodes_ = nullptr;
  bool all_ = true;
};

}  // namespace pliant

#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/mesh/sides.hpp>

namespace pliant {

/// Numbers by facets, which are told by their corners: a hash table of which no more than a quarter is taken.
template <int Dim>
class FacetTable {
 public:
  FacetTable() = default;
  /// For so many facets at most.
  explicit FacetTable(std::size_t most)
      : entry_(most == 0 ? 0 : std::bit_ceil(4 * most), -1),
        corners_(most == 0 ? 0 : std::bit_ceil(most)) {
    keys_.reserve(most);
    numbers_.reserve(most);
  }

  void add(Facet<Dim> const& facet, std::size_t number) {
    auto place = home_of(facet);
    while (entry_[place] >= 0) place = next(place);
    entry_[place] = static_cast<Index>(keys_.size());
    keys_.push_back(mesh::key_of(facet));
    numbers_.push_back(number);
    for (std::size_t k = 0; k < facet.corners(); ++k) word_of(facet[k]) |= bit_of(facet[k]);
  }
  [[nodiscard]] bool empty() const { return keys_.empty(); }
  /// False for most facets that were not added.
  [[nodiscard]] bool may_have(Facet<Dim> const& facet) const {
    // Most facets have other first nodes.
    if (empty() || !may_have(facet[0])) return false;
    for (std::size_t k = 1; k < facet.corners(); ++k)
      if (!may_have(facet[k])) return false;
    return true;
  }
  /// Of a facet that was added several times the first one.
  [[nodiscard]] std::optional<std::size_t> find(Facet<Dim> const& facet) const {
    if (!may_have(facet)) return std::nullopt;
    auto place = home_of(facet);
    if (entry_[place] < 0) return std::nullopt;
    auto const key = mesh::key_of(facet);
    for (; entry_[place] >= 0; place = next(place))
      if (auto const own = static_cast<std::size_t>(entry_[place]); keys_[own] == key)
        return numbers_[own];
    return std::nullopt;
  }

 private:
  /// Of the corners of facets that were added, modulo their count.
  [[nodiscard]] std::uint64_t& word_of(Index corner) {
    return corners_[static_cast<std::size_t>(corner) / 64 & (corners_.size() - 1)];
  }
  [[nodiscard]] bool may_have(Index corner) const {
    auto const word = static_cast<std::size_t>(corner) / 64 & (corners_.size() - 1);
    return (corners_[word] & bit_of(corner)) != 0;
  }
  static std::uint64_t bit_of(Index corner) {
    return std::uint64_t{1} << (static_cast<std::size_t>(corner) % 64);
  }
  /// The same for the corners in any order.
  [[nodiscard]] std::size_t home_of(Facet<Dim> const& facet) const {
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < facet.corners(); ++k) {
      auto const x = static_cast<std::uint64_t>(facet[k] + 1) * 0x9e3779b97f4a7c15;
      sum += x ^ (x >> 32);
    }
    return static_cast<std::size_t>(sum ^ (sum >> 29)) & (entry_.size() - 1);
  }
  [[nodiscard]] std::size_t next(std::size_t place) const {
    return (place + 1) & (entry_.size() - 1);
  }

  std::vector<Index> entry_;                // a power of two; -1: free
  std::vector<std::uint64_t> corners_;      // a power of two, 64 corners each
  std::vector<std::array<Index, 4>> keys_;  // by the entry
  std::vector<std::size_t> numbers_;
};

}  // namespace pliant

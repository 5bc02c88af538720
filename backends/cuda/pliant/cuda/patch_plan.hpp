#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant::detail {

/// Where an element finds its nodes in its patch, and where it puts their shares.
template <int Nodes>
struct alignas(16) PatchRow {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  std::uint16_t local[width];  // which of the patch's nodes
  std::uint16_t slot[width];   // which place in the patch's staging memory
};

/// A node of a patch, and how many slots it has there.
struct PatchNode {
  Index node = -1;  // -1: none
  Index valence = 0;
};

/// A patch is a run of consecutive elements that one thread block works on. Every share that an
/// element has in a node gets a slot of its own. A patch's nodes are sorted by valence (the
/// number of their slots), largest first, so that the k-th slots of all nodes that have one lie
/// side by side: node r's are diagonals[0] + r, diagonals[1] + r, ... (jagged diagonals), which
/// neighbouring threads read from neighbouring addresses without loading indices.
template <int Nodes>
struct PatchPlan {
  int patch_size = 0;  // elements
  Index patches = 0;
  int node_capacity = 0;                 // of a patch; multiple of 4
  int diagonal_capacity = 0;             // of a patch; multiple of 4
  std::vector<PatchRow<Nodes>> rows;     // (elements)
  std::vector<PatchNode> nodes;          // (patches, node_capacity)
  std::vector<std::uint16_t> diagonals;  // (patches, diagonal_capacity)
};

/// Plans patches, one after the other. Nodes were checked before.
template <int Nodes>
class PatchPlanner {
 public:
  static constexpr int lanes = 32;  // of a warp; also the banks of shared memory

  PatchPlanner(std::vector<std::array<Index, Nodes>> const& connectivity, Index nodes,
               int patch_size)
      : connectivity_(connectivity), owner_(static_cast<std::size_t>(std::max(nodes, Index{0}))) {
    if (patch_size * Nodes >= 1 << 16)
      throw Error("patches of ", patch_size,
                  " elements have more slots than 16 "
                  "bits can number; make them smaller");
    plan_.patch_size = patch_size;
    plan_.rows.resize(connectivity.size());
  }

  PatchPlan<Nodes> plan() && {
    auto const count = static_cast<Index>(connectivity_.size());
    for (Index first = 0; first < count; first += plan_.patch_size) {
      std::size_t const size = static_cast<std::size_t>(std::min(plan_.patch_size, count - first));
      elements_ = std::span(connectivity_).subspan(static_cast<std::size_t>(first), size);
      rows_ = std::span(plan_.rows).subspan(static_cast<std::size_t>(first), size);
      number_nodes();
      sort_by_valence();
      assign_slots();
      ++plan_.patches;
    }
    pad();
    return std::move(plan_);
  }

 private:
  struct Owner {
    Index patch = -1, local = 0;
  };
  struct Found {
    Index node;
    int valence = 0;     // then: how many slots are free
    int rank = 0;        // by valence
    int first_free = 0;  // in free_
  };

  void number_nodes() {
    found_.clear();
    for (std::size_t e = 0; e < elements_.size(); ++e)
      for (std::size_t a = 0; a < Nodes; ++a) {
        Index const node = elements_[e][a];
        Owner& owner = owner_[static_cast<std::size_t>(node)];
        if (owner.patch != plan_.patches) {
          owner = {plan_.patches, static_cast<Index>(found_.size())};
          found_.push_back({node});
        }
        rows_[e].local[a] = static_cast<std::uint16_t>(owner.local);
        ++found_[static_cast<std::size_t>(owner.local)].valence;
      }
  }

  void sort_by_valence() {
    int largest = 0;
    for (Found const& n : found_) largest = std::max(largest, n.valence);
    starts_.assign(static_cast<std::size_t>(largest) + 1, 0);  // by largest − valence
    for (Found const& n : found_) ++starts_[static_cast<std::size_t>(largest - n.valence)];
    for (int rank = 0; int& start : starts_) rank += std::exchange(start, rank);

    std::size_t const seen = nodes_.size();
    first_node_.push_back(seen);
    first_diagonal_.push_back(diagonals_.size());
    nodes_.resize(seen + found_.size());
    free_.clear();
    for (Found& n : found_) {
      n.rank = starts_[static_cast<std::size_t>(largest - n.valence)]++;
      nodes_[seen + static_cast<std::size_t>(n.rank)] = {n.node, n.valence};
    }
    // After the loop above starts_[largest − v] counts the nodes whose valence is v or more.
    lengths_.assign(starts_.rbegin() + 1, starts_.rend());
    for (int slot = 0; int length : lengths_) {
      diagonals_.push_back(static_cast<std::uint16_t>(slot));
      slot += length;
    }
    for (Found& n : found_) {
      n.first_free = static_cast<int>(free_.size());
      for (int d = 0; d < n.valence; ++d)
        free_.push_back(static_cast<std::uint16_t>(
            diagonals_[first_diagonal_.back() + static_cast<std::size_t>(d)] + n.rank));
    }
  }

  /// Any of a node's slots will do for any of its elements, so take one whose memory bank few
  /// threads of the warp write to at the same time.
  void assign_slots() {
    for (std::size_t first = 0; first < elements_.size(); first += lanes) {
      std::size_t const last = std::min(first + lanes, elements_.size());
      for (std::size_t a = 0; a < Nodes; ++a) {
        std::array<int, lanes> writers{};
        for (std::size_t e = first; e < last; ++e) {
          Found& n = found_[rows_[e].local[a]];
          std::uint16_t* const free = free_.data() + n.first_free;
          int best = 0;
          for (int k = 1; k < n.valence && writers[free[best] % lanes] > 0; ++k)
            if (writers[free[k] % lanes] < writers[free[best] % lanes]) best = k;
          rows_[e].slot[a] = free[best];
          ++writers[free[best] % lanes];
          free[best] = free[--n.valence];
          rows_[e].local[a] = static_cast<std::uint16_t>(n.rank);
        }
      }
    }
  }

  void pad() {
    first_node_.push_back(nodes_.size());
    first_diagonal_.push_back(diagonals_.size());
    plan_.node_capacity = capacity(first_node_);
    plan_.diagonal_capacity = capacity(first_diagonal_);
    plan_.nodes = padded(nodes_, first_node_, plan_.node_capacity);
    plan_.diagonals = padded(diagonals_, first_diagonal_, plan_.diagonal_capacity);
  }
  static int capacity(std::vector<std::size_t> const& first) {
    std::size_t largest = 0;
    for (std::size_t p = 1; p < first.size(); ++p)
      largest = std::max(largest, first[p] - first[p - 1]);
    return static_cast<int>((largest + 3) / 4 * 4);
  }
  template <class U>
  static std::vector<U> padded(std::vector<U> const& rows, std::vector<std::size_t> const& first,
                               int capacity) {
    std::vector<U> out((first.size() - 1) * static_cast<std::size_t>(capacity));
    for (std::size_t p = 1; p < first.size(); ++p)
      std::copy(rows.begin() + static_cast<std::ptrdiff_t>(first[p - 1]),
                rows.begin() + static_cast<std::ptrdiff_t>(first[p]),
                out.begin() + static_cast<std::ptrdiff_t>(p - 1) * capacity);
    return out;
  }

  std::vector<std::array<Index, Nodes>> const& connectivity_;
  PatchPlan<Nodes> plan_;
  std::vector<Owner> owner_;  // (nodes)
  // Of the current patch:
  std::span<std::array<Index, Nodes> const> elements_;
  std::span<PatchRow<Nodes>> rows_;
  std::vector<Found> found_;
  std::vector<int> starts_, lengths_;
  std::vector<std::uint16_t> free_;  // slots that no element has, by node
  // Compressed rows of all patches:
  std::vector<std::size_t> first_node_, first_diagonal_;
  std::vector<PatchNode> nodes_;
  std::vector<std::uint16_t> diagonals_;
};

}  // namespace pliant::detail

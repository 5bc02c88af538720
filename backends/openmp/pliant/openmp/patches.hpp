#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/math/group_by_key.hpp>

namespace pliant::detail {

/// Elements cut into patches, the unit of work of a thread. A patch owns the nodes that no earlier
/// patch touches and adds to them in place; what it adds to a node of another patch goes to a
/// scratch row of its own behind the nodes, and scratch rows are folded into their nodes in the
/// order of the patches. So no two threads ever add to one address, and the result has the same
/// bits whatever the number of threads. Inside a patch the elements are kept ordered by group.
template <int Nodes>
class Patches {
 public:
  static constexpr int nodes_per_element = Nodes;
  /// Elements; swept by bench, flat from 1024 to 8192.
  static constexpr Index patch_size() { return 2048; }

  Patches() = default;
  Patches(std::vector<std::array<Index, Nodes>> const& connectivity, int groups,
          std::vector<Tag> const& tags, Index nodes)
      : groups_(groups),
        connectivity_(connectivity.size() * Nodes),
        target_(connectivity.size() * Nodes),
        tags_(tags.size()),
        ordered_tags_(tags.size()),
        order_(connectivity.size()) {
    check_nodes(connectivity, nodes);
    tags_.upload(tags);
    tag_data_ = tags_.data();
    for (std::size_t e = 0; e < connectivity.size(); ++e)
      std::ranges::copy(connectivity[e], connectivity_.data() + e * Nodes);
    assign_targets(nodes);
    bounds_.resize(static_cast<std::size_t>(patch_count()) * static_cast<std::size_t>(groups + 1));
    std::ranges::copy(tags, ordered_tags_.data());
    for (Index p = 0; p < patch_count(); ++p) order(p);
  }

  Index count() const { return static_cast<Index>(order_.size()); }
  Index patch_count() const { return (count() + patch_size() - 1) / patch_size(); }
  Index scratch_nodes() const { return scratch_nodes_; }
  HostArray<Tag>& tags() { return tags_; }
  HostArray<Tag> const& tags() const { return tags_; }
  HostArray<Tag> take_tags() { return std::move(tags_); }

  Index const* nodes(Index e) const { return connectivity_.data() + std::ptrdiff_t{Nodes} * e; }
  /// The rows that an element adds to: its nodes, or scratch rows.
  Index const* targets(Index e) const { return target_.data() + std::ptrdiff_t{Nodes} * e; }
  /// The elements of a patch that belong to a group, in ascending order.
  std::span<Index const> members(Index patch, int group) const {
    auto const at = static_cast<std::size_t>(patch * (groups_ + 1) + group);
    return {order_.data() + bounds_[at], order_.data() + bounds_[at + 1]};
  }
  /// The scratch rows that a patch adds to: [first, last).
  std::pair<Index, Index> scratch_of(Index patch) const {
    auto const p = static_cast<std::size_t>(patch);
    return {scratch_first_[p], scratch_first_[p + 1]};
  }
  Index folded_count() const { return static_cast<Index>(folded_.size()); }
  /// A node that has scratch rows, and these rows, in the order of the patches.
  struct Folded {
    Index node;
    std::span<Index const> rows;
  };
  Folded folded(Index k) const {
    auto const i = static_cast<std::size_t>(k);
    return {folded_[i],
            {fold_rows_.data() + fold_first_[i], fold_rows_.data() + fold_first_[i + 1]}};
  }

  /// Where a scratch row is folded, and which patch adds to it.
  Folded folded_of_row(Index row) const {
    return folded(row_folds_[static_cast<std::size_t>(row - first_row())]);
  }
  Index patch_of_row(Index row) const {
    return row_patches_[static_cast<std::size_t>(row - first_row())];
  }

  /// Orders the elements of each patch by group, stably; patches whose tags did not change keep their
  /// order without a look.
  void regroup() {
    for (Index p = 0; p < patch_count(); ++p) {
      auto const first = static_cast<std::size_t>(p * patch_size());
      auto const size =
          std::min(ordered_tags_.size() - first, static_cast<std::size_t>(patch_size()));
      if (std::equal(tag_data_ + first, tag_data_ + first + size, ordered_tags_.data() + first))
        continue;
      std::copy_n(tag_data_ + first, size, ordered_tags_.data() + first);
      order(p);
    }
  }

 private:
  Index first_row() const { return scratch_first_.front(); }
  void order(Index patch) {
    Index const first = patch * patch_size(), last = std::min(count(), first + patch_size());
    Index* next = order_.data() + first;
    auto bound = bounds_.begin() + patch * (groups_ + 1);
    for (int g = 0; g < groups_; ++g) {
      *bound++ = static_cast<Index>(next - order_.data());
      for (Index e = first; e < last; ++e)
        if (tag_data_[e] == g) *next++ = e;
    }
    *bound = static_cast<Index>(next - order_.data());
  }

  void assign_targets(Index nodes) {
    std::vector<Index> owner(static_cast<std::size_t>(nodes), -1);
    std::vector<Index> row(static_cast<std::size_t>(nodes), -1);  // in the current patch
    std::vector<Index> foreign;                                   // nodes, by scratch row
    Index next = nodes;
    for (Index p = 0; p < patch_count(); ++p) {
      scratch_first_.push_back(next);
      std::size_t const seen = foreign.size();
      Index const first = p * patch_size(), last = std::min(count(), first + patch_size());
      for (std::ptrdiff_t k = std::ptrdiff_t{Nodes} * first; k < std::ptrdiff_t{Nodes} * last;
           ++k) {
        auto const node = static_cast<std::size_t>(connectivity_.data()[k]);
        if (owner[node] < 0) owner[node] = p;
        if (owner[node] != p && row[node] < 0) {
          row[node] = next++;
          foreign.push_back(static_cast<Index>(node));
        }
        target_.data()[k] = owner[node] == p ? static_cast<Index>(node) : row[node];
      }
      for (std::size_t k = seen; k < foreign.size(); ++k)
        row[static_cast<std::size_t>(foreign[k])] = -1;
    }
    scratch_first_.push_back(next);
    scratch_nodes_ = next - nodes;
    // Rows ascend with the patch, so inside a node too.
    auto const by_node = group_by_key(foreign, nodes);
    for (Index node = 0; node < nodes; ++node) {
      Index const first = by_node.first[static_cast<std::size_t>(node)];
      if (first == by_node.first[static_cast<std::size_t>(node) + 1]) continue;
      folded_.push_back(node);
      fold_first_.push_back(first);
    }
    fold_first_.push_back(scratch_nodes_);
    fold_rows_ = by_node.order;
    for (Index& fold_row : fold_rows_) fold_row += nodes;
    row_folds_.resize(static_cast<std::size_t>(scratch_nodes_));
    row_patches_.resize(row_folds_.size());
    for (std::size_t k = 0; k < folded_.size(); ++k)
      for (Index r : folded(static_cast<Index>(k)).rows)
        row_folds_[static_cast<std::size_t>(r - nodes)] = static_cast<Index>(k);
    for (Index p = 0; p < patch_count(); ++p)
      for (auto [r, last] = scratch_of(p); r < last; ++r)
        row_patches_[static_cast<std::size_t>(r - nodes)] = p;
  }

  int groups_ = 1;
  HostArray<Index> connectivity_, target_;  // (elements, Nodes)
  HostArray<Tag> tags_, ordered_tags_;      // as they are, and as the order knows them
  Tag const* tag_data_ = nullptr;           // whoever owns them
  HostArray<Index> order_;                  // elements, ordered by group inside each patch
  std::vector<Index> bounds_;               // (patches, groups + 1)
  Index scratch_nodes_ = 0;
  std::vector<Index> scratch_first_;                    // (patches + 1)
  std::vector<Index> folded_, fold_first_, fold_rows_;  // compressed rows
  std::vector<Index> row_folds_, row_patches_;          // (scratch rows)
};

}  // namespace pliant::detail

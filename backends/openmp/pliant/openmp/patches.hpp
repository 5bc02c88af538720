#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/backend/patch_cuts.hpp>
#include <pliant/openmp/fans.hpp>
#include <pliant/openmp/patch_rows.hpp>

namespace pliant::detail {

/// Elements cut into patches, the unit of work of a thread (see PatchRows). Inside a patch the elements are kept ordered
/// by group. Those of four nodes whose nodes may be given in another order stand in fans as well.
template <int Nodes>
class Patches {
 public:
  static constexpr int nodes_per_element = Nodes;
  static constexpr bool may_have_fans = Nodes == 4;

  Patches() = default;
  /// `before`: the table before a change, which has what was planned for the blocks that stay (see PlansByBlocks).
  Patches(std::vector<std::array<Index, Nodes>> connectivity, int groups,
          std::vector<Tag> const& tags, Index nodes, NodeOrder node_order,
          ElementBlocks const& blocks = {}, Patches const* before = nullptr)
      : groups_(groups),
        has_fans_(may_have_fans && node_order == NodeOrder::any_even),
        given_(std::move(connectivity)),
        nodes_(given_.data()),
        tags_(std::span<Tag const>(tags)),
        ordered_tags_(std::span<Tag const>(tags)),
        tag_data_(tags_.data()),
        cuts_(static_cast<Index>(tags.size()), largest_patch, blocks),
        order_(HostArray<Index>::unset(tags.size())) {
    check_nodes(given_, nodes);
    if (before != nullptr && blocks.some_stay()) carry(blocks, *before);
    if (has_fans_)
      fans_ = Fans(all_nodes(), cuts_.first(), nodes, blocks,
                   before == nullptr ? nullptr : &before->fans_);
    else
      rows_ = PatchRows(
          {all_nodes(), tags.size() * Nodes}, patch_count(),
          [&](Index p) { return std::ptrdiff_t{Nodes} * cuts_.first(p); }, nodes);
    bounds_.resize(static_cast<std::size_t>(patch_count()) * static_cast<std::size_t>(groups + 1));
    for_each_on_host(patch_count(), few_patches, [&](Index p) { order(p); });
  }

  Index count() const { return static_cast<Index>(order_.size()); }
  Index patch_size() const { return cuts_.size(); }
  Index patch_count() const { return cuts_.count(); }
  PatchRanges patches() const { return cuts_.ranges(); }
  std::span<Index const> patch_bounds() const { return cuts_.first(); }
  PatchRows const& rows() const { return has_fans_ ? fans_.rows() : rows_; }
  Index scratch_nodes() const { return rows().scratch_nodes(); }
  HostArray<Tag>& tags() { return tags_; }
  HostArray<Tag> const& tags() const { return tags_; }
  HostArray<Tag> take_tags() { return std::move(tags_); }

  ElementRows rows_of_nodes() const { return {all_nodes(), Nodes}; }
  Index const* nodes(Index e) const { return nodes_[static_cast<std::size_t>(e)].data(); }
  bool has_fans() const { return has_fans_; }
  Fans const& fans() const { return fans_; }
  /// The elements of a patch that belong to a group, in ascending order.
  std::span<Index const> members(Index patch, int group) const {
    auto const at = static_cast<std::size_t>(patch * (groups_ + 1) + group);
    return {order_.data() + bounds_[at], order_.data() + bounds_[at + 1]};
  }

  /// Orders the elements of each patch by group, stably; patches whose tags did not change keep their
  /// order without a look.
  void regroup() {
    for (Index p = 0; p < patch_count(); ++p) {
      Index const first = cuts_.first(p), size = cuts_.first(p + 1) - first;
      if (std::equal(tag_data_ + first, tag_data_ + first + size, ordered_tags_.data() + first))
        continue;
      std::copy_n(tag_data_ + first, size, ordered_tags_.data() + first);
      order(p);
    }
  }

 private:
  Index const* all_nodes() const { return count() == 0 ? nullptr : nodes(0); }
  /// Puts what was given between the elements that stay.
  void carry(ElementBlocks const& blocks, Patches const& before) {
    auto const first_node = [](std::array<Index, Nodes> const* rows) {
      return rows == nullptr ? nullptr : rows->data();
    };
    carried_ = HostArray<std::array<Index, Nodes>>::unset(order_.size());
    auto const sources = sources_of(blocks);
    CarryConnectivity<Nodes, Nodes> const carry{
        blocks.first.data(),
        sources.data(),
        static_cast<Index>(sources.size()),
        first_node(before.nodes_),
        first_node(given_.data()),
        carried_.size() == 0 ? nullptr : carried_.data()->data()};
    constexpr Index few_blocks = 32;  // worth a thread
    for_each_on_host(carry.blocks, few_blocks, [&](Index block) {
      auto const b = static_cast<std::size_t>(block);
      for (Index e = blocks.first[b]; e < blocks.first[b + 1]; ++e) carry.carry(block, e);
    });
    nodes_ = carried_.data();
    given_ = {};
  }
  void order(Index patch) {
    Index const first = cuts_.first(patch), last = cuts_.first(patch + 1);
    Index* next = order_.data() + first;
    auto bound = bounds_.begin() + patch * (groups_ + 1);
    bool const alike = are_alike(tag_data_ + first, last - first);
    for (int g = 0; g < groups_; ++g) {
      *bound++ = static_cast<Index>(next - order_.data());
      if (alike && tag_data_[first] == g) {
        std::iota(next, next + (last - first), first);
        next += last - first;
      }
      for (Index e = first; !alike && e < last; ++e)
        if (tag_data_[e] == g) *next++ = e;
    }
    *bound = static_cast<Index>(next - order_.data());
    if (has_fans_) fans_.order(patch, tag_data_, groups_);
  }

  /// Elements; swept by bench, flat from 1024 to 8192.
  static constexpr Index largest_patch = 2048;
  static constexpr Index few_patches = 4;  // worth a thread

  int groups_ = 1;
  bool has_fans_ = false;
  std::vector<std::array<Index, Nodes>> given_;      // (elements), or none where they are
  HostArray<std::array<Index, Nodes>> carried_;      // (elements)
  std::array<Index, Nodes> const* nodes_ = nullptr;  // of one of these
  PatchRows rows_;                                   // of the connectivity, where there are no fans
  Fans fans_;
  HostArray<Tag> tags_, ordered_tags_;  // as they are, and as the order knows them
  Tag const* tag_data_ = nullptr;       // whoever owns them
  HostPatches cuts_;
  HostArray<Index> order_;     // elements, ordered by group inside each patch
  std::vector<Index> bounds_;  // (patches, groups + 1)
};

/// The rows that the elements of a patch add to, its nodes' or scratch rows.
template <int Nodes>
class PatchTargets {
 public:
  PatchTargets(Patches<Nodes> const& elements, Index patch)
      : first_(elements.patch_bounds()[static_cast<std::size_t>(patch)]) {
    if (!elements.has_fans()) {
      targets_ = elements.rows().targets() + std::ptrdiff_t{Nodes} * first_;
      return;
    }
    of_fans_.resize(static_cast<std::size_t>(Nodes * elements.patch_size()));
    targets_ = of_fans_.data();
    auto const& fans = elements.fans();
    fans.for_each_element(patch, [&](Index e, auto const& corners) {
      for (int a = 0; a < Nodes; ++a)
        for (Index corner : corners)
          if (fans.nodes()[corner] == elements.nodes(e)[a])
            of_fans_[static_cast<std::size_t>(Nodes * (e - first_) + a)] = fans.targets()[corner];
    });
  }
  Index const* of(Index e) const { return targets_ + std::ptrdiff_t{Nodes} * (e - first_); }

 private:
  Index first_;
  Index const* targets_ = nullptr;
  std::vector<Index> of_fans_;
};

}  // namespace pliant::detail

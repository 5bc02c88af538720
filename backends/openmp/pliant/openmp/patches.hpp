#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/backend/patch_cuts.hpp>
#include <pliant/openmp/fan_block.hpp>
#include <pliant/openmp/patch_connectivity.hpp>
#include <pliant/openmp/patch_order.hpp>
#include <pliant/openmp/patch_plan.hpp>
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
  /// `before`: the table before a change, with which this one shares what stays (see PlansByBlocks).
  Patches(std::vector<std::array<Index, Nodes>> connectivity, int groups,
          std::vector<Tag> const& tags, Index nodes, NodeOrder node_order,
          ElementBlocks const& blocks = {}, Patches const* before = nullptr)
      : groups_(groups),
        has_fans_(may_have_fans && node_order == NodeOrder::any_even),
        tags_(tags.empty()
                  ? HostArray<Tag>(static_cast<std::size_t>(blocks.count(connectivity.size())))
                  : HostArray<Tag>(std::span<Tag const>(tags))),
        tag_data_(tags_.data()),
        cuts_(blocks.count(connectivity.size()), PatchOrder::largest, blocks),
        plans_(static_cast<std::size_t>(patch_count())),
        orders_(plans_.size()) {
    check_nodes(connectivity, nodes);
    if (before != nullptr && blocks.some_stay()) {
      auto const known = cuts_.known_from(before->cuts_, blocks);
      for (std::size_t p = 0; p < known.size(); ++p)
        if (known[p] >= 0) keep(p, *before, static_cast<std::size_t>(known[p]));
      connectivity_ = {connectivity, cuts_, blocks, known, before->connectivity_, before->cuts_};
    } else {
      connectivity_ = {std::move(connectivity), cuts_};
    }
    if (has_fans_)
      fan_blocks_ = FanBlocks([&](Index e) { return this->nodes(e); }, count(), blocks,
                              before == nullptr ? nullptr : &before->fan_blocks_);
    plan();
    rows_ = PatchRows(
        patch_count(), [&](Index p) -> auto const& { return plan_of(p).nodes; }, nodes);
    if (!has_fans_) find_targets();
    for_each_on_host(patch_count(), few_patches, [&](Index p) { order(p); });
  }

  Index count() const { return cuts_.first().back(); }
  Index patch_size() const { return cuts_.size(); }
  Index patch_count() const { return cuts_.count(); }
  PatchRanges patches() const { return cuts_.ranges(); }
  std::span<Index const> patch_bounds() const { return cuts_.first(); }
  PatchRows const& rows() const { return rows_; }
  Index scratch_nodes() const { return rows_.scratch_nodes(); }
  HostArray<Tag>& tags() { return tags_; }
  HostArray<Tag> const& tags() const { return tags_; }
  HostArray<Tag> take_tags() { return std::move(tags_); }

  ElementRows rows_of_nodes() const {
    auto const* const rows = connectivity_.flat(cuts_);
    return {rows == nullptr ? nullptr : rows->data(), Nodes};
  }
  Index const* nodes(Index e) const { return connectivity_.row(cuts_, e)->data(); }
  /// Of an element of a patch.
  Index const* nodes(Index patch, Index e) const {
    return connectivity_.rows(patch)[e - cuts_.first(patch)].data();
  }
  /// Of a table without fans: the rows that its elements' shares are added to, (elements, nodes).
  Index const* targets() const { return targets_.data(); }
  PatchPlan const& plan_of(Index patch) const { return *plans_[static_cast<std::size_t>(patch)]; }
  bool has_fans() const { return has_fans_; }
  PatchFans fans(Index patch) const {
    auto const& plan = plan_of(patch);
    return {plan.fans, plan.places.data(), plan.nodes.data(), rows_.targets(patch),
            cuts_.first(patch)};
  }
  /// What a patch has of a group, in ascending order; numbered in the patch.
  std::span<std::uint16_t const> members(Index patch, int group) const {
    return orders_[static_cast<std::size_t>(patch)].members(group);
  }
  /// The same of fans, long runs first.
  std::span<FanRun const> runs(Index patch, int group) const {
    return orders_[static_cast<std::size_t>(patch)].runs(group, plan_of(patch).fans);
  }

  /// Orders the elements of each patch by group, stably; patches whose tags did not change keep their
  /// order.
  void regroup() {
    for_each_on_host(patch_count(), few_patches, [&](Index p) {
      if (!orders_[static_cast<std::size_t>(p)].is_of(tag_data_ + cuts_.first(p), size_of(p)))
        order(p);
    });
  }

 private:
  static_assert(PatchOrder::largest * Nodes <= 65536, "places of a patch have two bytes");
  static constexpr Index few_patches = 4;  // worth a thread

  Index size_of(Index patch) const { return cuts_.first(patch + 1) - cuts_.first(patch); }
  void keep(std::size_t patch, Patches const& before, std::size_t known) {
    plans_[patch] = before.plans_[known];
    orders_[patch] = before.orders_[known];
  }
  void plan() {
    std::vector<Index> patches;
    for (Index p = 0; p < patch_count(); ++p)
      if (plans_[static_cast<std::size_t>(p)] == nullptr) patches.push_back(p);
    HostParts(static_cast<Index>(patches.size()), few_patches)([&](Index from, Index to, int) {
      NodeNumbers numbers;
      for (Index k = from; k < to; ++k) {
        Index const p = patches[static_cast<std::size_t>(k)], first = cuts_.first(p);
        auto const rows_of = [&](Index e) { return nodes(e); };
        plans_[static_cast<std::size_t>(p)] = std::make_shared<PatchPlan const>(
            has_fans_ ? plan_fans(fan_blocks_, first, cuts_.first(p + 1), rows_of, numbers)
                      : plan_elements(rows_of(first), size_of(p), Nodes, numbers));
      }
    });
  }
  void find_targets() {
    targets_ = HostArray<Index>::unset(static_cast<std::size_t>(count()) * Nodes);
    for_each_on_host(patch_count(), few_patches, [&](Index p) {
      Index* target = targets_.data() + std::ptrdiff_t{Nodes} * cuts_.first(p);
      for (auto const place : plan_of(p).places) *target++ = std::as_const(rows_).targets(p)[place];
    });
  }
  void order(Index patch) {
    orders_[static_cast<std::size_t>(patch)].order(tag_data_ + cuts_.first(patch), size_of(patch),
                                                   groups_,
                                                   has_fans_ ? &plan_of(patch).fans : nullptr);
  }

  int groups_ = 1;
  bool has_fans_ = false;
  HostArray<Tag> tags_;
  Tag const* tag_data_ = nullptr;  // whoever owns them
  HostPatches cuts_;
  PatchConnectivity<Nodes> connectivity_;
  FanBlocks fan_blocks_;
  std::vector<std::shared_ptr<PatchPlan const>> plans_;  // (patches)
  PatchRows rows_;                                       // of the nodes of plans
  HostArray<Index> targets_;                             // (elements, nodes); empty with fans
  std::vector<PatchOrder> orders_;                       // (patches)
};

/// The rows that the elements of a patch add to, its nodes' or scratch rows.
template <int Nodes>
class PatchTargets {
 public:
  PatchTargets(Patches<Nodes> const& elements, Index patch)
      : first_(elements.patch_bounds()[static_cast<std::size_t>(patch)]) {
    if (!elements.has_fans()) {
      targets_ = elements.targets() + std::ptrdiff_t{Nodes} * first_;
      return;
    }
    of_fans_.resize(static_cast<std::size_t>(Nodes * elements.patch_size()));
    targets_ = of_fans_.data();
    auto const fans = elements.fans(patch);
    fans.for_each_element([&](Index e, auto const& corners) {
      for (int a = 0; a < Nodes; ++a)
        for (auto const corner : corners)
          if (fans.nodes[corner] == elements.nodes(patch, e)[a])
            of_fans_[static_cast<std::size_t>(Nodes * (e - first_) + a)] = fans.targets[corner];
    });
  }
  Index const* of(Index e) const { return targets_ + std::ptrdiff_t{Nodes} * (e - first_); }

 private:
  Index first_;
  Index const* targets_ = nullptr;
  std::vector<Index> of_fans_;
};

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <array>
#include <atomic>
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
        connectivity_(HostArray<Index>::unset(connectivity.size() * Nodes)),
        target_(HostArray<Index>::unset(connectivity.size() * Nodes)),
        tags_(std::span<Tag const>(tags)),
        ordered_tags_(std::span<Tag const>(tags)),
        tag_data_(tags_.data()),
        order_(HostArray<Index>::unset(connectivity.size())) {
    check_nodes(connectivity, nodes);
    for_each_on_host(count(), few_elements(Nodes), [&](Index e) {
      std::ranges::copy(connectivity[static_cast<std::size_t>(e)],
                        connectivity_.data() + std::ptrdiff_t{Nodes} * e);
    });
    assign_targets(nodes);
    bounds_.resize(static_cast<std::size_t>(patch_count()) * static_cast<std::size_t>(groups + 1));
    for_each_on_host(patch_count(), few_patches, [&](Index p) { order(p); });
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

  /// The places of a patch in the connectivity: [first, last).
  std::pair<std::ptrdiff_t, std::ptrdiff_t> places_of(Index patch) const {
    Index const first = patch * patch_size(), last = std::min(count(), first + patch_size());
    return {std::ptrdiff_t{Nodes} * first, std::ptrdiff_t{Nodes} * last};
  }
  /// visit(k) for each of them.
  template <class Visit>
  void for_each_place(Index patch, Visit const& visit) const {
    auto const [first, last] = places_of(patch);
    for (auto k = first; k < last; ++k) visit(k);
  }
  /// The first patch that has each node; −1: none.
  std::vector<Index> owners(Index nodes) const {
    std::vector<Index> owner(static_cast<std::size_t>(nodes), -1);
    HostParts const parts(patch_count(), few_patches);
    auto const own = [&](Index first, Index last, auto const& lower) {
      for (Index p = first; p < last; ++p)
        for_each_place(p, [&](std::ptrdiff_t k) {
          lower(owner[static_cast<std::size_t>(connectivity_.data()[k])], p);
        });
    };
    parts([&](Index first, Index last, int) {
      if (parts.count() == 1)
        return own(first, last, [](Index& kept, Index p) { kept = kept < 0 ? p : kept; });
      own(first, last, [](Index& kept, Index p) {
        std::atomic_ref shared(kept);
        Index before = shared.load(std::memory_order_relaxed);
        while ((before < 0 || p < before) &&
               !shared.compare_exchange_weak(before, p, std::memory_order_relaxed)) {
        }
      });
    });
    return owner;
  }
  /// A node as a patch knows it that has it.
  struct Known {
    Index patch = -1;  // the last one that asked
    Index target = 0;  // where it adds
  };
  /// Numbers the scratch rows of a patch from `begin` on, in the order in which its elements first have their nodes, which
  /// go to `foreign`. is_own(node, known): asked once for each node of the patch.
  template <class IsOwn>
  void number_rows(Index patch, Index begin, std::vector<Known>& known, std::vector<Index>& foreign,
                   IsOwn const& is_own) {
    Index const* const nodes = connectivity_.data();
    Index* const target = target_.data();
    Known* const all = known.data();
    auto const [first, last] = places_of(patch);
    for (auto k = first; k < last; ++k) {
      if (all[nodes[k]].patch != patch) number_row(patch, begin, all, nodes[k], foreign, is_own);
      target[k] = all[nodes[k]].target;
    }
  }
  template <class IsOwn>
  PLIANT_SELDOM static void number_row(Index patch, Index begin, Known* all, Index node,
                                       std::vector<Index>& foreign, IsOwn const& is_own) {
    Known& own = all[node];
    own.target = node;
    if (!is_own(node, own)) {
      own.target = begin + static_cast<Index>(foreign.size());
      foreign.push_back(node);
    }
    own.patch = patch;
  }

  void assign_targets(Index nodes) {
    std::vector<std::vector<Index>> foreign_of(static_cast<std::size_t>(patch_count()));
    Index const of_thread = patch_count() / HostThreads::now();
    HostParts const parts(patch_count(), std::max(few_patches, of_thread));
    bool const in_order =
        parts.count() == 1;  // else each patch begins at `nodes`, until all are counted
    std::vector<Index> owner;
    if (!in_order) owner = owners(nodes);
    parts([&](Index first, Index last, int) {
      std::vector<Known> known(static_cast<std::size_t>(nodes));
      Index begin = nodes;
      for (Index p = first; p < last; ++p) {
        auto& foreign = foreign_of[static_cast<std::size_t>(p)];
        if (in_order) {
          number_rows(p, begin, known, foreign,
                      [](Index, Known const& own) { return own.patch < 0; });
          begin += static_cast<Index>(foreign.size());
        } else {
          number_rows(p, begin, known, foreign, [&](Index node, Known const&) {
            return owner[static_cast<std::size_t>(node)] == p;
          });
        }
      }
    });
    std::vector<Index> foreign;  // nodes, by scratch row
    for (auto const& of_patch : foreign_of) {
      scratch_first_.push_back(nodes + static_cast<Index>(foreign.size()));
      foreign.insert(foreign.end(), of_patch.begin(), of_patch.end());
    }
    scratch_nodes_ = static_cast<Index>(foreign.size());
    scratch_first_.push_back(nodes + scratch_nodes_);
    if (!in_order)
      for_each_on_host(patch_count(), few_patches, [&](Index p) {
        Index const before = scratch_of(p).first - nodes;
        for_each_place(p, [&](std::ptrdiff_t k) {
          if (target_.data()[k] >= nodes) target_.data()[k] += before;
        });
      });
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

  static constexpr Index few_patches = 4;  // worth a thread

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

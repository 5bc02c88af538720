#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_array.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/math/unset_vector.hpp>

namespace pliant::detail {

/// The rows that patches add to. A patch owns the nodes that no earlier patch touches and adds to them in place; what it
/// adds to a node of another patch goes to a scratch row of its own behind the nodes, and scratch rows are folded into
/// their nodes in the order of the patches. So no two threads ever add to one address, and the result has the same
/// bits whatever the number of threads.
class PatchRows {
 public:
  PatchRows() = default;
  /// Of patches with the nodes nodes_of(patch), each once, of `nodes` in all.
  template <class NodesOf>
  PatchRows(Index patches, NodesOf const& nodes_of, Index nodes) {
    first_.reserve(static_cast<std::size_t>(patches) + 1);
    for (Index p = 0; p < patches; ++p)
      first_.push_back(first_.back() + static_cast<std::ptrdiff_t>(nodes_of(p).size()));
    target_ = HostArray<Index>::unset(static_cast<std::size_t>(first_.back()));
    fold(HostThreads::now() == 1 ? assign_in_order(nodes_of, nodes) : assign(nodes_of, nodes),
         nodes);
  }

  /// The row of each node of a patch: the node's, or a scratch row.
  Index const* targets(Index patch) const {
    return target_.data() + first_[static_cast<std::size_t>(patch)];
  }
  Index scratch_nodes() const { return static_cast<Index>(row_folds_.size()); }
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

 private:
  static constexpr Index few_patches = 4, few_rows = 16384;  // worth a thread

  Index first_row() const { return scratch_first_.front(); }

  Index patches() const { return static_cast<Index>(first_.size()) - 1; }
  Index* targets(Index patch) { return target_.data() + first_[static_cast<std::size_t>(patch)]; }

  /// Assigns targets. Scratch rows are numbered patch by patch, as these have their nodes: gives their nodes.
  template <class NodesOf>
  std::vector<Index> assign_in_order(NodesOf const& nodes_of, Index nodes) {
    std::vector<char> is_taken(static_cast<std::size_t>(nodes), 0);
    std::vector<Index> foreign(target_.size());
    Index rows = 0;
    for (Index p = 0; p < patches(); ++p) {
      scratch_first_.push_back(nodes + rows);
      Index* target = targets(p);
      for (Index const node : nodes_of(p)) {
        char& taken = is_taken[static_cast<std::size_t>(node)];
        Index const own = taken - 1;  // all bits, or none: compilers take a choice for a branch
        *target++ = (node & own) | ((nodes + rows) & ~own);
        foreign[static_cast<std::size_t>(rows)] = node;
        rows += taken;
        taken = 1;
      }
    }
    scratch_first_.push_back(nodes + rows);
    foreign.resize(static_cast<std::size_t>(rows));
    return foreign;
  }
  /// The same on several threads.
  template <class NodesOf>
  std::vector<Index> assign(NodesOf const& nodes_of, Index nodes) {
    auto const owner = owners(nodes_of, nodes);
    auto const is_own = [&](Index node, Index p) {
      return owner[static_cast<std::size_t>(node)] == p;
    };
    scratch_first_.resize(first_.size());
    for_each_on_host(patches(), few_patches, [&](Index p) {
      Index rows = 0;
      for (Index const node : nodes_of(p)) rows += is_own(node, p) ? 0 : 1;
      scratch_first_[static_cast<std::size_t>(p) + 1] = rows;
    });
    scratch_first_.front() = nodes;
    for (std::size_t p = 1; p < scratch_first_.size(); ++p)
      scratch_first_[p] += scratch_first_[p - 1];
    std::vector<Index> foreign(static_cast<std::size_t>(scratch_first_.back() - nodes));
    for_each_on_host(patches(), few_patches, [&](Index p) {
      Index row = scratch_of(p).first;
      Index* target = targets(p);
      for (Index const node : nodes_of(p)) {
        if (!is_own(node, p)) foreign[static_cast<std::size_t>(row - nodes)] = node;
        *target++ = is_own(node, p) ? node : row++;
      }
    });
    return foreign;
  }
  /// The first patch that has each node; −1: none.
  template <class NodesOf>
  std::vector<Index> owners(NodesOf const& nodes_of, Index nodes) const {
    std::vector<Index> owner(static_cast<std::size_t>(nodes), -1);
    for_each_on_host(patches(), few_patches, [&](Index p) {
      for (Index const node : nodes_of(p)) {
        std::atomic_ref kept(owner[static_cast<std::size_t>(node)]);
        Index before = kept.load(std::memory_order_relaxed);
        while ((before < 0 || p < before) &&
               !kept.compare_exchange_weak(before, p, std::memory_order_relaxed)) {
        }
      }
    });
    return owner;
  }

  /// Rows ascend with the patch, so inside a node too. `foreign`: the nodes of scratch rows.
  void fold(std::vector<Index> const& foreign, Index nodes) {
    std::vector<std::uint64_t> has_rows(static_cast<std::size_t>(nodes) / 64 + 1);  // a bit a node
    for (Index const node : foreign)
      has_rows[static_cast<std::size_t>(node) / 64] |= std::uint64_t{1} << (node % 64);
    auto fold_of = HostArray<Index>::unset(static_cast<std::size_t>(nodes));  // by such nodes
    folded_.resize(foreign.size());
    Index count = 0;
    for (std::size_t word = 0; word < has_rows.size(); ++word)
      for (auto left = has_rows[word]; left != 0; left &= left - 1) {
        auto const node = static_cast<Index>(64 * word) + std::countr_zero(left);
        fold_of.data()[node] = count;
        folded_[static_cast<std::size_t>(count++)] = node;
      }
    folded_.resize(static_cast<std::size_t>(count));
    row_folds_.resize(foreign.size());
    for_each_on_host(scratch_nodes(), few_rows, [&](Index r) {
      auto const row = static_cast<std::size_t>(r);
      row_folds_[row] = fold_of.data()[foreign[row]];
    });
    auto by_fold = group_by_key(row_folds_, folded_count());
    fold_first_ = std::move(by_fold.first);
    fold_rows_ = std::move(by_fold.order);
    for (Index& row : fold_rows_) row += nodes;
    row_patches_.resize(foreign.size());
    for_each_on_host(patches(), few_patches, [&](Index p) {
      auto const [first, last] = scratch_of(p);
      std::fill_n(row_patches_.begin() + (first - nodes), last - first, p);
    });
  }

  std::vector<std::ptrdiff_t> first_{0};  // (patches + 1), targets
  HostArray<Index> target_;
  std::vector<Index> scratch_first_;  // (patches + 1)
  std::vector<Index> folded_;
  UnsetVector<Index> fold_first_, fold_rows_;   // by these: compressed rows
  std::vector<Index> row_folds_, row_patches_;  // (scratch rows)
};

}  // namespace pliant::detail

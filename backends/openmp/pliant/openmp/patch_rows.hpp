#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_array.hpp>
#include <pliant/math/group_by_key.hpp>

namespace pliant::detail {

/// The rows that patches add to. A patch owns the nodes that no earlier patch touches and adds to them in place; what it
/// adds to a node of another patch goes to a scratch row of its own behind the nodes, and scratch rows are folded into
/// their nodes in the order of the patches. So no two threads ever add to one address, and the result has the same
/// bits whatever the number of threads.
class PatchRows {
 public:
  PatchRows() = default;
  /// Of places that have the nodes place_nodes; those of patch p are first_place(p) to first_place(p + 1).
  template <class FirstPlace>
  PatchRows(std::span<Index const> place_nodes, Index patches, FirstPlace const& first_place,
            Index nodes)
      : target_(HostArray<Index>::unset(place_nodes.size())) {
    auto const for_each_place = [&](Index p, auto const& visit) {
      for (std::ptrdiff_t k = first_place(p), last = first_place(p + 1); k < last; ++k) visit(k);
    };
    assign_targets(place_nodes.data(), patches, for_each_place, nodes);
  }

  /// The row of each place: its node, or a scratch row.
  Index const* targets() const { return target_.data(); }
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
  static constexpr Index few_patches = 4;  // worth a thread

  Index first_row() const { return scratch_first_.front(); }

  /// The first patch that has each node; −1: none.
  template <class ForEachPlace>
  static std::vector<Index> owners(Index const* node_of, Index patches,
                                   ForEachPlace const& for_each_place, Index nodes) {
    std::vector<Index> owner(static_cast<std::size_t>(nodes), -1);
    HostParts const parts(patches, few_patches);
    auto const own = [&](Index first, Index last, auto const& lower) {
      for (Index p = first; p < last; ++p)
        for_each_place(
            p, [&](std::ptrdiff_t k) { lower(owner[static_cast<std::size_t>(node_of[k])], p); });
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
  template <class IsOwn>
  PLIANT_SELDOM static void number_row(Index patch, Index begin, Known& known, Index node,
                                       std::vector<Index>& foreign, IsOwn const& is_own) {
    known.target = node;
    if (!is_own(node, known)) {
      known.target = begin + static_cast<Index>(foreign.size());
      foreign.push_back(node);
    }
    known.patch = patch;
  }

  template <class ForEachPlace>
  void assign_targets(Index const* node_of, Index patches, ForEachPlace const& for_each_place,
                      Index nodes) {
    std::vector<std::vector<Index>> foreign_of(static_cast<std::size_t>(patches));
    Index const of_thread = patches / HostThreads::now();
    HostParts const parts(patches, std::max(few_patches, of_thread));
    bool const in_order =
        parts.count() == 1;  // else each patch begins at `nodes`, until all are counted
    std::vector<Index> owner;
    if (!in_order) owner = owners(node_of, patches, for_each_place, nodes);
    Index* const target = target_.data();
    parts([&](Index first, Index last, int) {
      std::vector<Known> known(static_cast<std::size_t>(nodes));
      Index begin = nodes;
      // Scratch rows are numbered as the places of the patch first have their nodes.
      auto const number = [&](Index p, auto const& is_own) {
        auto& foreign = foreign_of[static_cast<std::size_t>(p)];
        for_each_place(p, [&](std::ptrdiff_t k) {
          Known& own = known[static_cast<std::size_t>(node_of[k])];
          if (own.patch != p) number_row(p, begin, own, node_of[k], foreign, is_own);
          target[k] = own.target;
        });
        if (in_order) begin += static_cast<Index>(foreign.size());
      };
      for (Index p = first; p < last; ++p) {
        if (in_order)
          number(p, [](Index, Known const& own) { return own.patch < 0; });
        else
          number(p, [&](Index node, Known const&) {
            return owner[static_cast<std::size_t>(node)] == p;
          });
      }
    });
    std::vector<Index> foreign;  // nodes, by scratch row
    for (auto const& of_patch : foreign_of) {
      scratch_first_.push_back(nodes + static_cast<Index>(foreign.size()));
      foreign.insert(foreign.end(), of_patch.begin(), of_patch.end());
    }
    scratch_first_.push_back(nodes + static_cast<Index>(foreign.size()));
    if (!in_order)
      for_each_on_host(patches, few_patches, [&](Index p) {
        Index const before = scratch_of(p).first - nodes;
        for_each_place(p, [&](std::ptrdiff_t k) {
          if (target[k] >= nodes) target[k] += before;
        });
      });
    fold(foreign, nodes);
    row_patches_.resize(foreign.size());
    for (Index p = 0; p < patches; ++p)
      for (auto [r, last] = scratch_of(p); r < last; ++r)
        row_patches_[static_cast<std::size_t>(r - nodes)] = p;
  }

  /// Rows ascend with the patch, so inside a node too.
  void fold(std::vector<Index> const& foreign, Index nodes) {
    auto const by_node = group_by_key(foreign, nodes);
    std::size_t count = 0;  // without a branch for each node
    folded_.resize(foreign.size() + 1);
    fold_first_.resize(foreign.size() + 1);
    for (Index node = 0; node < nodes; ++node) {
      Index const first = by_node.first[static_cast<std::size_t>(node)];
      folded_[count] = node;
      fold_first_[count] = first;
      if (first != by_node.first[static_cast<std::size_t>(node) + 1]) ++count;
    }
    folded_.resize(count);
    fold_first_.resize(count + 1);
    fold_first_.back() = static_cast<Index>(foreign.size());
    fold_rows_ = by_node.order;
    for (Index& fold_row : fold_rows_) fold_row += nodes;
    row_folds_.resize(foreign.size());
    for (std::size_t k = 0; k < folded_.size(); ++k)
      for (Index r : folded(static_cast<Index>(k)).rows)
        row_folds_[static_cast<std::size_t>(r - nodes)] = static_cast<Index>(k);
  }

  HostArray<Index> target_;                             // (places)
  std::vector<Index> scratch_first_;                    // (patches + 1)
  std::vector<Index> folded_, fold_first_, fold_rows_;  // compressed rows
  std::vector<Index> row_folds_, row_patches_;          // (scratch rows)
};

}  // namespace pliant::detail

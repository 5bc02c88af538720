#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/body/touched_elements.hpp>

// What a layout takes from the one before a change of topology.
namespace pliant::detail {

/// The layout L before a change, and what the change means. `looked_at`: nodes by the new number, among them all of
/// which the mass may be another.
template <class L, class M>
struct LayoutChange {
  L const& before;
  Transfer<M::dim> const& transfer;
  TouchedElements<M> const& touched;
  std::vector<Index> const& looked_at;
};

/// The nodes of blocks around which a change of topology changed nothing: each block had them before, and no block before it,
/// and so it has now. `change`: null where there was none.
template <class L, class M>
class KeptNodes {
 public:
  KeptNodes(LayoutChange<L, M> const* change, ChangedBlocks const& changed) : changed_(changed) {
    if (change == nullptr || change->before.first_nodes[0].empty()) return;
    change_ = change;
    old_numbers_ = change->transfer.old_numbers();
  }
  bool keeps(std::size_t block) const { return change_ != nullptr && changed_.nodes[block] == 0; }
  /// Whether a block that keeps not all has no nodes but such as it had, in their order: those that others before it have now
  /// are missing. Where nodes go, or elements become others of another type, blocks behind take nodes over.
  bool keeps_some(std::size_t block) const {
    return change_ != nullptr && TypesOf<M>::count == 1 && changed_.elements[block] == 0 &&
           change_->transfer.staying_nodes() == change_->transfer.old_nodes();
  }
  Index count(std::size_t type, std::size_t block) const {
    auto const& first = change_->before.first_nodes[type];
    return first[block + 1] - first[block];
  }
  /// visit(user's number)
  template <class Visit>
  void for_each(std::size_t type, std::size_t block, Visit const& visit) const {
    auto const& before = change_->before;
    auto const& first = before.first_nodes[type];
    for (auto old = static_cast<std::size_t>(first[block]);
         old < static_cast<std::size_t>(first[block + 1]); ++old)
      visit(change_->transfer.renumbered(before.user_node[old]));
  }
  /// Whether a node, by the user's number, is among them.
  auto has() const {
    return [this, type = std::size_t{0}, block = std::size_t{0}](Index node) mutable {
      if (change_ == nullptr || node >= change_->transfer.staying_nodes()) return false;
      Index const old = change_->before.internal_of(
          old_numbers_.empty() ? node : old_numbers_[static_cast<std::size_t>(node)]);
      auto const& first = change_->before.first_nodes;
      auto const is_in = [&](std::size_t t, std::size_t b) {
        return first[t][b] <= old && old < first[t][b + 1];
      };
      if (is_in(type, block)) return keeps(block);
      for (std::size_t t = 0; t < first.size(); ++t) {
        if (old < first[t].front() || old >= first[t].back()) continue;
        type = t;
        block = static_cast<std::size_t>(std::ranges::upper_bound(first[t], old) -
                                         first[t].begin() - 1);
        return keeps(block);
      }
      return false;
    };
  }

 private:
  LayoutChange<L, M> const* change_ = nullptr;
  ChangedBlocks const& changed_;
  std::vector<Index> old_numbers_;
};

/// The numbering of a topology, its elements in their order, and, where there was a change, what it means for their blocks.
template <Element... Es>
struct Numbered {
  Numbering<Es...> numbering;
  OrderedElements<sizeof...(Es)> ordered;
  ChangedBlocks changed;
};
/// `first`: the order of the body's first mesh; null: this is it. `change`: null where there was none.
template <class L, Element... Es>
Numbered<Es...> numbered(Topology<Mesh<Es...>> const& topology, CellOrder const* first,
                         LayoutChange<L, Mesh<Es...>> const* change) {
  if (first == nullptr || !topology.tree)
    return {Numbering<Es...>(topology.mesh()), {{}, first_blocks(topology.mesh())}, {}};
  OrderedElements<sizeof...(Es)> ordered;
  ChangedBlocks changed;
  if (change != nullptr) {
    changed = changed_blocks(topology, *first, change->transfer, change->touched);
    auto const before = change->before.order(change->transfer, changed.elements);
    ordered = elements_in_order(topology, *first, &before);
  } else {
    ordered = elements_in_order(topology, *first);
  }
  KeptNodes<L, Mesh<Es...>> const kept(change, changed);
  Numbering<Es...> numbering(topology, ordered.cells, kept);
  return {std::move(numbering), std::move(ordered), std::move(changed)};
}

/// Where the nodes of blocks are now: by the block, the first number before, and from there on numbers that follow each
/// other from `now`, or, where that is negative, those of a list from −1 − now on.
struct CarryNumbers {
  Index const *first, *now, *list;
  Index* to;
  PLIANT_HOST_DEVICE void operator()(Index block) const {
    Index const begin = first[block], count = first[block + 1] - begin, at = now[block];
    for (Index i = 0; i < count; ++i) to[begin + i] = at >= 0 ? at + i : list[i - 1 - at];
  }
};

/// What has become of the nodes before a change, by the internal number there, in the backend's memory; −1: gone. `first_now`:
/// the first nodes of blocks after it, internal_of(user): a number after it.
template <class B, class L, class M, class FirstNow, class InternalOf>
auto nodes_now(B const& backend, LayoutChange<L, M> const& change, KeptNodes<L, M> const& kept,
               FirstNow const& first_now, InternalOf const& internal_of) {
  auto const& before = change.before;
  std::vector<Index> first, now, list;
  auto const add_listed = [&](Index begin, Index end) {
    first.push_back(begin);
    now.push_back(-1 - static_cast<Index>(list.size()));
    for (auto old = static_cast<std::size_t>(begin); old < static_cast<std::size_t>(end); ++old) {
      Index const user = change.transfer.renumbered(before.user_node[old]);
      list.push_back(user < 0 ? Index{-1} : internal_of(user));
    }
  };
  Index next = 0;
  for (std::size_t type = 0; type < before.first_nodes.size(); ++type) {
    auto const& own = before.first_nodes[type];
    for (std::size_t b = 0; b + 1 < own.size(); ++b) {
      next = own[b + 1];
      if (!kept.keeps(b)) {
        add_listed(own[b], next);
        continue;
      }
      first.push_back(own[b]);
      now.push_back(first_now[type][b]);
    }
  }
  if (next < before.nodes) add_listed(next, before.nodes);  // of no block
  first.push_back(before.nodes);
  auto const first_on = upload(backend, first), now_on = upload(backend, now),
             list_on = upload(backend, list);
  auto to = backend.template array<Index>(static_cast<std::size_t>(before.nodes));
  backend.for_each(static_cast<Index>(now.size()),
                   CarryNumbers{first_on.data(), now_on.data(), list_on.data(), to.data()});
  backend.synchronize();  // before the lists go
  return to;
}

}  // namespace pliant::detail

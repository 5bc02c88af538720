#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/openmp/fan_block.hpp>
#include <pliant/openmp/fan_list.hpp>

namespace pliant::detail {

/// Numbers the nodes of a patch as they come.
class NodeNumbers {
 public:
  /// Begins anew, and puts nodes into `nodes` as they come.
  void begin(std::vector<Index>& nodes) {
    nodes_ = &nodes;
    if (++patch_ == 0) slots_.assign(slots_.size(), {});
    patch_ = std::max(patch_, 1u);
  }
  std::uint16_t of(Index node) {
    if (2 * nodes_->size() >= slots_.size()) grow();
    Slot& slot = slot_of(node);
    if (slot.patch != patch_) {
      slot = {node, patch_, static_cast<std::uint16_t>(nodes_->size())};
      nodes_->push_back(node);
    }
    return slot.number;
  }

 private:
  struct Slot {
    Index node = 0;
    unsigned patch = 0;  // that which filled it
    std::uint16_t number = 0;
  };

  Slot& slot_of(Index node) {
    auto const mask = slots_.size() - 1;
    auto k = static_cast<std::uint64_t>(node) * 0x9E3779B97F4A7C15u >> 40 & mask;
    while (slots_[k].patch == patch_ && slots_[k].node != node) k = (k + 1) & mask;
    return slots_[k];
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(2048, 2 * slots_.size()), {});
    for (std::size_t k = 0; k < nodes_->size(); ++k)
      slot_of((*nodes_)[k]) = {(*nodes_)[k], patch_, static_cast<std::uint16_t>(k)};
  }

  std::vector<Slot> slots_;
  std::vector<Index>* nodes_ = nullptr;
  unsigned patch_ = 0;
};

/// A patch in terms of itself and of its nodes: tables share it as long as the patch has the same elements of the same nodes,
/// whatever these elements are numbered.
struct PatchPlan {
  std::vector<Index> nodes;  // each once, as places first have them
  std::vector<std::uint16_t>
      places;    // numbers of `nodes`: of (elements, nodes), or of corners of fans
  FanList fans;  // where the table has some
};

/// Of `count` elements with the nodes rows[nodes_per_element · count].
inline PatchPlan plan_elements(Index const* rows, Index count, int nodes_per_element,
                               NodeNumbers& numbers) {
  PatchPlan plan;
  numbers.begin(plan.nodes);
  plan.places.resize(static_cast<std::size_t>(nodes_per_element) * static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < plan.places.size(); ++k) plan.places[k] = numbers.of(rows[k]);
  return plan;
}

/// Of the elements [begin, end) in fans of blocks, cut where the patch begins or ends in them. rows_of(e): the nodes of element
/// e, behind which are those of the others of its block.
template <class RowsOf>
PatchPlan plan_fans(FanBlocks const& blocks, Index begin, Index end, RowsOf const& rows_of,
                    NodeNumbers& numbers) {
  PatchPlan plan;
  numbers.begin(plan.nodes);
  FanList& fans = plan.fans;
  std::vector<Index> known;  // the number of each node of a block; −1: not yet
  auto const append = [](auto& list, auto const& others, auto const& value_of) {
    using Value = typename std::remove_reference_t<decltype(list)>::value_type;
    auto const before = list.size();
    list.resize(before + others.size());
    std::ranges::transform(others, list.begin() + static_cast<std::ptrdiff_t>(before),
                           [&](auto other) { return static_cast<Value>(value_of(other)); });
  };
  blocks.for_each_in(begin, end, [&](FanBlock const& block, Index first) {
    Index const* const rows = rows_of(first);
    if (begin <= first && first + static_cast<Index>(block.elements.size()) <= end) {
      known.clear();
      append(known, block.nodes, [&](Index place) { return numbers.of(rows[place]); });
      append(plan.places, block.corners,
             [&](Index k) { return known[static_cast<std::size_t>(k)]; });
      append(fans.elements, block.elements, [&](Index k) { return first - begin + k; });
      append(fans.sizes, block.sizes, [](unsigned char size) { return size; });
      return;
    }
    known.assign(block.nodes.size(), -1);
    auto const add_corners = [&](Index corner, int count) {
      for (int k = corner; k < corner + count; ++k) {
        auto const node = static_cast<std::size_t>(block.corners[static_cast<std::size_t>(k)]);
        if (known[node] < 0) known[node] = numbers.of(rows[block.nodes[node]]);
        plan.places.push_back(static_cast<std::uint16_t>(known[node]));
      }
    };
    auto const element = [&](Index k) {
      return first + block.elements[static_cast<std::size_t>(k)];
    };
    auto const is_in = [&](Index k) { return begin <= element(k) && element(k) < end; };
    Index corner = 0, member = 0;
    for (int const size : block.sizes) {
      for (int from = 0, to = 0; from < size; from = to) {
        bool const own = is_in(member + from);
        while (to < size && is_in(member + to) == own) ++to;
        if (!own) continue;
        add_corners(corner, 2);
        add_corners(corner + 2 + from, to - from + 1);
        for (int k = from; k < to; ++k)
          fans.elements.push_back(static_cast<std::uint16_t>(element(member + k) - begin));
        fans.sizes.push_back(static_cast<unsigned char>(to - from));
      }
      corner += size + 3;
      member += size;
    }
  });
  fans.order_runs();
  return plan;
}

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <pliant/adaptation/refinement.hpp>
#include <pliant/topology/marked_elements.hpp>

namespace pliant::detail {

/// Lists of the elements of one type that rules want changed: what is refined, else raised, else split, else
/// merged or lowered.
template <class... Rules>
class MeshLists {
 public:
  /// Begins lists in `marked`, which it refers to. `max_level` grows to the rules'.
  MeshLists(std::tuple<Rules...> const& rules, MarkedElements& marked, int& max_level)
      : lists_{&marked.refine,  &marked.raise, &marked.split, &marked.split_in_two,
               &marked.coarsen, &marked.lower, &marked.merge} {
    for (auto* list : lists_) list->emplace_back();
    int r = 0;
    auto const look_at = [&]<class R>(R const& rule) {
      auto const add_to = [&](auto const& list) {
        for (std::size_t l = 0; l < lists_.size(); ++l)
          if (lists_[l] == &list) rules_[l] |= std::uint32_t{1} << r;
      };
      if constexpr (RefiningRule<R>) {
        add_to(marked.refine);
        max_level = std::max(max_level, rule.options.max_level);
      } else if constexpr (CoarseningRule<R>) {
        add_to(marked.coarsen);
      } else if constexpr (RaisingRule<R>) {
        add_to(marked.raise);
        marked.raised_rings = std::max(marked.raised_rings, rule.options.ring);
      } else if constexpr (LoweringRule<R>) {
        add_to(marked.lower);
      } else if constexpr (SplittingRule<R>) {
        add_to(rule.options.triangles == 2 ? marked.split_in_two : marked.split);
      } else if constexpr (MergingRule<R>) {
        add_to(marked.merge);
      }
      ++r;
    };
    std::apply([&](auto const&... rule) { (look_at(rule), ...); }, rules);
  }

  /// An element, by the user's number, that some rules want changed: a bit for each.
  void add(Index element, std::uint32_t by_rules) {
    for (std::size_t l = 0; l < lists_.size(); ++l) {
      if ((by_rules & rules_[l]) == 0) continue;
      lists_[l]->back().push_back(element);
      if (l < first_of_last_) break;
    }
  }

 private:
  static constexpr std::size_t first_of_last_ = 4;  // an element can be in more than one of these
  std::array<std::vector<std::vector<Index>>*, 7> lists_;
  std::array<std::uint32_t, 7> rules_{};  // bits of those of each list
};

}  // namespace pliant::detail

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <pliant/openmp/fan_block.hpp>

namespace pliant::detail {

/// Consecutive elements of one group in a fan of a patch. Element k has the corners `ends`, ends + 1, ring + k, ring + k + 1.
struct FanRun {
  std::uint16_t ends, ring;  // corners of the patch
  std::uint16_t elements;    // the first, in the order of fans
  std::uint16_t size;
};

/// Runs by group, in each of them long ones first.
class FanRuns {
 public:
  FanRuns() = default;
  /// Those that for_each_run(visit) visits, by visit(group, run); groups from `groups` on are left out.
  template <class ForEachRun>
  FanRuns(int groups, ForEachRun const& for_each_run) {
    std::vector<Index> next(static_cast<std::size_t>(groups * most_host_fan_elements) + 1);
    auto const place = [&](int group, int size) -> Index& {
      return next[static_cast<std::size_t>((group + 1) * most_host_fan_elements - size)];
    };
    for_each_run([&](int group, FanRun const& run) {
      if (group < groups) ++place(group, run.size);
    });
    Index before = 0;
    for (Index& n : next) before += std::exchange(n, before);
    for (int g = 0; g < groups; ++g) bounds_.push_back(place(g, most_host_fan_elements));
    bounds_.push_back(before);
    runs_.resize(static_cast<std::size_t>(before));
    for_each_run([&](int group, FanRun const& run) {
      if (group < groups) runs_[static_cast<std::size_t>(place(group, run.size)++)] = run;
    });
  }
  std::span<FanRun const> of(int group) const {
    auto const g = static_cast<std::size_t>(group);
    return {runs_.data() + bounds_[g], runs_.data() + bounds_[g + 1]};
  }

 private:
  std::vector<FanRun> runs_;
  std::vector<Index> bounds_;  // (groups + 1)
};

/// Tetrahedra of a patch in fans around edges: whoever works on a fan at once visits 3 + n nodes for n elements.
struct FanList {
  std::vector<std::uint16_t> elements;  // of the patch, in the order of fans
  std::vector<unsigned char> sizes;     // of the fans, in elements
  FanRuns runs;                         // where all elements are of one group, as of group 0

  /// Finds the runs by the sizes.
  void order_runs() {
    runs = FanRuns(
        1, [&](auto const& visit) { for_each_fan([&](FanRun const& fan) { visit(0, fan); }); });
  }
  /// visit(fan, as one run) for all fans.
  template <class Visit>
  void for_each_fan(Visit const& visit) const {
    unsigned corner = 0, element = 0;
    for (unsigned const size : sizes) {
      visit(FanRun{static_cast<std::uint16_t>(corner), static_cast<std::uint16_t>(corner + 2),
                   static_cast<std::uint16_t>(element), static_cast<std::uint16_t>(size)});
      corner += size + 3;
      element += size;
    }
  }
  /// The runs of elements with these tags.
  FanRuns by_group(Tag const* tags, int groups) const {
    return FanRuns(groups, [&](auto const& visit) {
      for_each_fan([&](FanRun const& fan) {
        for (unsigned from = 0, to = 0; from < fan.size; from = to) {
          Tag const tag = tags[elements[fan.elements + from]];
          while (to < fan.size && tags[elements[fan.elements + to]] == tag) ++to;
          visit(int{tag}, FanRun{fan.ends, static_cast<std::uint16_t>(fan.ring + from),
                                 static_cast<std::uint16_t>(fan.elements + from),
                                 static_cast<std::uint16_t>(to - from)});
        }
      });
    });
  }
};

/// The fans of a patch of a table.
struct PatchFans {
  FanList const& list;
  std::uint16_t const* corners;  // numbers of nodes of the patch
  Index const *nodes, *targets;  // by these numbers
  Index first_element;

  /// visit(element, the numbers of its four nodes) for all elements.
  template <class Visit>
  void for_each_element(Visit const& visit) const {
    list.for_each_fan([&](FanRun const& fan) {
      for (int k = 0; k < fan.size; ++k)
        visit(first_element + list.elements[static_cast<std::size_t>(fan.elements + k)],
              std::array<std::uint16_t, 4>{corners[fan.ends], corners[fan.ends + 1],
                                           corners[fan.ring + k], corners[fan.ring + k + 1]});
    });
  }
};

}  // namespace pliant::detail

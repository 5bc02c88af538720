#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/topology/marked_elements.hpp>

namespace pliant::detail {

/// MarkedElements that loops take: for each type the user's numbers, in the backend's memory or on the host, where they stay while
/// these are in use. Lists of no types mark none.
template <Backend B>
struct MarkedThere {
  struct List {
    std::span<Index const> on_host{};             // (count); or empty, and
    typename B::template Array<Index> numbers{};  // (count), and room
    Index count = 0;

    [[nodiscard]] std::vector<Index> values() const {
      if (!on_host.empty()) return {on_host.begin(), on_host.end()};
      std::vector<Index> values(static_cast<std::size_t>(count));
      numbers.download(values);
      return values;
    }
  };
  std::vector<List> refine{}, coarsen{}, raise{}, lower{}, split{}, split_in_two{}, merge{};
  int raised_rings = 0;

  static std::vector<List> of(ListsOfTypes lists) {
    std::vector<List> there;
    for (auto const& list : lists) there.push_back({list, {}, static_cast<Index>(list.size())});
    return there;
  }
  static std::size_t count_on_host(std::vector<List> const& lists) {
    std::size_t count = 0;
    for (auto const& list : lists) count += list.on_host.size();
    return count;
  }
  static bool none_in(std::vector<List> const& lists) {
    return std::ranges::all_of(lists, [](List const& list) { return list.count == 0; });
  }
  /// Whether some are to get another degree.
  [[nodiscard]] bool converts() const { return !none_in(raise) || !none_in(lower); }
  [[nodiscard]] bool splits() const { return !none_in(split) || !none_in(split_in_two); }
  [[nodiscard]] bool merges() const { return !none_in(merge); }
  /// How many kinds of changes are asked for.
  [[nodiscard]] int kinds() const {
    return !none_in(refine) + !none_in(coarsen) + !none_in(raise) + !none_in(lower) + splits() +
           merges();
  }
  /// Those to refine and to coarsen, on the host.
  [[nodiscard]] MarkedElements lists() const {
    auto const values_of = [](std::vector<List> const& from) {
      std::vector<std::vector<Index>> to;
      for (auto const& list : from) to.push_back(list.values());
      return to;
    };
    return {.refine = values_of(refine), .coarsen = values_of(coarsen)};
  }
};

}  // namespace pliant::detail

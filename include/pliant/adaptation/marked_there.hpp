#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/topology/marked_elements.hpp>

namespace pliant::detail {

/// MarkedElements in a backend's memory: for each type the user's numbers. Lists of no types mark none.
template <Backend B>
struct MarkedThere {
  struct List {
    typename B::template Array<Index> numbers{};  // (count), and room
    Index count = 0;
  };
  std::vector<List> refine{}, coarsen{}, raise{}, lower{}, split{}, split_in_two{}, merge{};
  int raised_rings = 0;

  static std::vector<List> of(B const& backend, std::vector<std::vector<Index>> const& lists) {
    std::vector<List> there;
    for (auto const& list : lists)
      there.push_back({list.empty() ? typename B::template Array<Index>{} : upload(backend, list),
                       static_cast<Index>(list.size())});
    return there;
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
    auto const download_all = [](std::vector<List> const& from) {
      std::vector<std::vector<Index>> to;
      for (auto const& list : from)
        list.numbers.download(to.emplace_back(static_cast<std::size_t>(list.count)));
      return to;
    };
    return {.refine = download_all(refine), .coarsen = download_all(coarsen)};
  }
};

}  // namespace pliant::detail

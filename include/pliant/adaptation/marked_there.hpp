#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/topology/marked_elements.hpp>

namespace pliant::detail {

/// MarkedElements that loops take: for each type the user's numbers, in the backend's memory or on the host. Those of a user stay where they
/// are while these are in use. Lists of no types mark none.
template <Backend B>
struct MarkedThere {
  struct List {
    std::span<Index const> on_host{};             // (count); or empty, and
    Index const* given = nullptr;                 // (count), a user's; or null, and
    typename B::template Array<Index> numbers{};  // (count), and room
    Index count = 0;

    /// In the backend's memory, where they are there.
    [[nodiscard]] Index const* there() const { return given != nullptr ? given : numbers.data(); }
    /// f(all of them, on the host)
    template <class F>
    void visit(B const& backend, F const& f) const {
      if (on_host.size() > 0 || count == 0) return f(on_host);
      auto const size = static_cast<std::size_t>(count);
      auto copy = unset<Index>(backend, size);
      copy_values<B, Index>(backend, there(), copy.data(), size);
      auto const values = download<Index>(copy);
      f(std::span(values));
    }
  };
  std::vector<List> refine{}, coarsen{}, raise{}, lower{}, split{}, split_in_two{}, merge{};
  int raised_rings = 0;

  static std::vector<List> of(ListsOfTypes<std::vector<Index>> lists) {
    std::vector<List> there;
    for (auto const& list : lists)
      there.push_back({list, nullptr, {}, static_cast<Index>(list.size())});
    return there;
  }
  static std::vector<List> of(ListsOfTypes<ElementsThere> lists) {
    std::vector<List> there;
    for (auto const& list : lists) there.push_back({{}, list.numbers, {}, list.count});
    return there;
  }
  template <class L>
  static MarkedThere of(MarkedLists<L> const& marked) {
    return {of(marked.refine), of(marked.coarsen),      of(marked.raise), of(marked.lower),
            of(marked.split),  of(marked.split_in_two), of(marked.merge), marked.raised_rings};
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
  /// On the host.
  [[nodiscard]] MarkedElements lists(B const& backend) const {
    auto const values_of = [&](std::vector<List> const& from) {
      std::vector<std::vector<Index>> to;
      for (auto const& list : from)
        list.visit(backend, [&](auto values) { to.emplace_back(values.begin(), values.end()); });
      return to;
    };
    return {values_of(refine), values_of(coarsen),      values_of(raise), values_of(lower),
            values_of(split),  values_of(split_in_two), values_of(merge), raised_rings};
  }
};

}  // namespace pliant::detail

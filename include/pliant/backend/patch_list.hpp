#pragma once

#include <algorithm>
#include <utility>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// The elements of a table in some of its patches.
template <class Elements>
struct ActiveElements {
  static constexpr int nodes = Elements::nodes_per_element;
  Elements const& elements;
  Index const* list;  // in the backend's memory: how many patches, then their numbers; null: all
  Index most;         // how many patches at most

  /// Of lists in the host's memory.
  Index patch_count() const { return list == nullptr ? most : std::clamp(list[0], Index{0}, most); }
  Index patch(Index k) const { return list == nullptr ? k : list[k + 1]; }
};

/// The elements of the patches of a list, for verbs over elements: accumulate(over(elements, list), ...).
/// The list is an Array<Index> of the backend: how many patches, then their numbers, each at most
/// once; what is behind them is not read. A count beyond the list's room or the table's patches stands
/// for these. It is read when the verb runs, so that a kernel can write
/// it and a recording replays with what the list then holds. Throws Error when it has no room for
/// the first number.
template <class Elements, class A>
ActiveElements<Elements> over(Elements const& elements, A const& list) {
  if (list.size() == 0)
    throw Error("over: a list of patches without values; the first one tells how many there are");
  auto const room = static_cast<Index>(list.size()) - 1;
  return {elements, list.data(), std::min(room, elements.patch_count())};
}

namespace detail {
template <class Elements>
ActiveElements<Elements> active(Elements const& elements) {
  return {elements, nullptr, elements.patch_count()};
}
template <class Elements>
ActiveElements<Elements> active(ActiveElements<Elements> const& elements) {
  return elements;
}
template <class Table>
inline constexpr int table_nodes = decltype(active(std::declval<Table const&>()))::nodes;
}  // namespace detail

}  // namespace pliant

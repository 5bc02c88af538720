#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/element_blocks.hpp>

// Tables of elements whose rows of nodes are in a backend's memory already.
namespace pliant {

/// Elements of a backend that take rows of nodes which are in its memory, and keep them: row_width entries for each element,
/// of which the first are its nodes. Tags, if there are any, are there too; else all elements are of group 0. What blocks
/// and the table before a change are for is said of PlansByBlocks, but the rows are those of all elements. Numbers of nodes
/// may not be checked.
template <class Elements, class B>
concept TakesRows =
    requires {
      { Elements::row_width } -> std::convertible_to<int>;
    } && std::constructible_from<Elements, B const&, typename B::template Array<Index>, int,
                                 typename B::template Array<Tag>, Index, NodeOrder,
                                 ElementBlocks const&, Elements const*>;

/// How many entries a row of nodes has for elements_of_rows.
template <class Elements>
inline constexpr int row_width = Elements::nodes_per_element;
template <class Elements>
  requires requires {
    { Elements::row_width } -> std::convertible_to<int>;
  }
inline constexpr int row_width<Elements> = Elements::row_width;

namespace detail {

/// Takes rows of nodes, and tags, from their places in a table.
template <int Width>
struct TakeElements {
  ElementRows from;
  Tag const* tags;
  Index const* places;
  Index* to;
  Tag* tags_to;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const* const row = from[places[i]];
    for (int a = 0; a < Width; ++a) to[static_cast<std::ptrdiff_t>(Width) * i + a] = row[a];
    tags_to[i] = tags[places[i]];
  }
};

/// The rows of some elements, one run [first, second) of them after another.
template <int Nodes>
std::vector<std::array<Index, Nodes>> taken_rows(Index const* rows,
                                                 std::vector<std::pair<Index, Index>> const& runs) {
  std::size_t count = 0;
  for (auto const& [first, last] : runs) count += static_cast<std::size_t>(last - first);
  std::vector<std::array<Index, Nodes>> taken;
  taken.reserve(count);
  for (auto const& [first, last] : runs)
    for (Index e = first; e < last; ++e)
      std::copy_n(rows + std::ptrdiff_t{Nodes} * e, Nodes, taken.emplace_back().begin());
  return taken;
}

}  // namespace detail

/// A table of elements whose rows of nodes, (elements, row_width<Elements>), and tags, (elements) or none, are in the backend's
/// memory: taken over where Elements is one that TakesRows, else copied. `nodes`: how many rows fields have. `before`: null, or
/// the table before a change in which blocks stay, which has to stay until the new one is settled; all rows are given then, too.
template <class Elements, Backend B>
Elements elements_of_rows(B const& backend, typename B::template Array<Index> rows, int groups,
                          typename B::template Array<Tag> tags, Index nodes,
                          NodeOrder order = NodeOrder::as_given, ElementBlocks const& blocks = {},
                          Elements const* before = nullptr) {
  if constexpr (TakesRows<Elements, B>) {
    return {backend, std::move(rows), groups, std::move(tags), nodes, order, blocks, before};
  } else {
    constexpr int width = Elements::nodes_per_element;
    auto const& numbers = on_host<Index>(rows);
    auto const taken = [&](bool all) {
      std::vector<std::pair<Index, Index>> runs;
      if (all) runs.emplace_back(0, blocks.count(numbers.size() / width));
      for (std::size_t b = 0; !all && b < blocks.stays.size(); ++b)
        if (blocks.stays[b] == 0) runs.emplace_back(blocks.first[b], blocks.first[b + 1]);
      return detail::taken_rows<width>(numbers.data(), runs);
    };
    if constexpr (PlansByBlocks<Elements, B>) {
      bool const all = before == nullptr || !blocks.some_stay();
      return {backend, taken(all), groups, download<Tag>(tags), nodes, order, blocks, before};
    } else {
      return {backend, taken(true), groups, download<Tag>(tags), nodes, order};
    }
  }
}

/// Waits for what a backend still does for a table that was made from one before a change, where it does; before loops over its
/// patches.
template <class Elements, Backend B>
void settle(B const& backend, Elements& elements) {
  if constexpr (requires { elements.settle(backend); }) elements.settle(backend);
}

/// A table as of elements_of_rows of the elements of another one at some places, (count). Places, and the tags of that, are in the
/// backend's memory.
template <class Elements, Backend B>
Elements element_list(B const& backend, Elements const& table, Tag const* tags, Index const* places,
                      Index count, int groups, Index nodes) {
  constexpr int width = row_width<Elements>;
  auto rows = unset<Index>(backend, static_cast<std::size_t>(count) * width);
  auto own_tags = unset<Tag>(backend, static_cast<std::size_t>(count));
  backend.for_each(count, detail::TakeElements<width>{table.rows_of_nodes(), tags, places,
                                                      rows.data(), own_tags.data()});
  return elements_of_rows<Elements>(backend, std::move(rows), groups, std::move(own_tags), nodes);
}

}  // namespace pliant

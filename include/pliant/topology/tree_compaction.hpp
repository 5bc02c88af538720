#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Takes away what nothing uses any more after cells of a tree became leaves, or leaves lost the nodes between their corners,
/// on the threads of the host. What the initial mesh has stays. Refers to the tree's lists.
///
/// What came before the last division before all of what goes is left alone but for what it knows of newer entries: see DivisionMarks.
class TreeCompaction {
 public:
  explicit TreeCompaction(TreeLists& lists)
      : lists_(lists), are_linear_(lists.quadratic_leaves == 0 && lists.converted.empty()) {}

  /// `touched` became leaves or lost their nodes, and `gone`, each once, were children of some of them.
  Renumbering operator()(std::vector<Index> const& touched, std::vector<Index> gone) {
    auto const& i = lists_.initial;
    auto const view = lists_.view();
    auto const unused = edges_and_sides_of(
        gone, size(lists_.cells),
        [&](Index e) { return e >= i.edges && !CompactionView::is_used(view.edges[at(e)]); },
        [&](Index s) { return s >= i.sides && !CompactionView::is_used(view.sides[at(s)]); });
    auto const cells = each_once(std::move(gone), lists_.cells.size()),
               nodes = nodes_that_go(touched);
    auto const &edges = unused.edges, &sides = unused.sides;
    auto const first = are_linear_
                           ? lists_.divisions.last_before(
                                 {front(cells), front(edges), front(sides), front(nodes)}, i)
                           : i;
    Numbers const node(lists_.nodes, first.nodes, nodes),
        cell(size(lists_.cells), first.cells, cells), edge(size(lists_.edges), first.edges, edges),
        side(size(lists_.sides), first.sides, sides);
    CompactionView const moved{view, i, node.view(), cell.view(), edge.view(), side.view()};
    auto const known = cells_that_know(touched, cell.first);
    auto const around = edges_and_sides_of(
        known, cell.first, [&](Index e) { return e < edge.first; },
        [&](Index s) { return s < side.first; });
    // Sides look at cells, which are still where they were.
    move_up(lists_.sides, around.sides, side, moved);
    move_up(lists_.edges, around.edges, edge, moved);
    move_up(lists_.cells, known, cell, moved);
    move_rows_up(cell, moved);
    for (Index& c : lists_.divided) c = moved.cells(c);
    lists_.nodes = node.count;
    lists_.divisions.renumber([&](TreeSizes const& before) -> TreeSizes {
      return {before.cells - count_before(cells, before.cells),
              before.edges - count_before(edges, before.edges),
              before.sides - count_before(sides, before.sides),
              before.nodes - count_before(nodes, before.nodes)};
    });
    return {{node.first, node.others}, {cell.first, cell.others}};
  }

 private:
  static constexpr Index few = 4096;
  struct EdgesAndSides {
    std::vector<Index> edges, sides;
  };

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  /// The first of a list; behind all where there is none.
  static Index front(std::vector<Index> const& list) {
    return list.empty() ? std::numeric_limits<Index>::max() : list.front();
  }
  /// How many of a list are below a number.
  static Index count_before(std::vector<Index> const& list, Index number) {
    return static_cast<Index>(std::ranges::lower_bound(list, number) - list.begin());
  }
  /// Nodes behind those of the initial mesh that no element has any more, ascending.
  [[nodiscard]] std::vector<Index> nodes_that_go(std::vector<Index> const& touched) const {
    return are_linear_ ? nodes_of_divisions(touched) : nodes_without_element();
  }
  /// Where elements have corners only: of the nodes that divided these cells, those that divide no other one.
  [[nodiscard]] std::vector<Index> nodes_of_divisions(std::vector<Index> const& touched) const {
    std::vector<Index> found;
    for (Index const c : touched)
      CompactionView::visit_nodes_that_go(lists_.view(), c, [&](Index node) {
        if (node >= lists_.initial.nodes) found.push_back(node);
      });
    return each_once(std::move(found), at(lists_.nodes));
  }
  [[nodiscard]] std::vector<Index> nodes_without_element() const {
    auto const& i = lists_.initial;
    CompactionView const view{.tree = lists_.view(), .staying = i};
    std::vector<std::uint8_t> is_used(at(lists_.nodes - i.nodes));
    auto const use = [&](Index node) {
      std::atomic_ref(is_used[at(node)]).store(1, std::memory_order_relaxed);
    };
    for_each_on_host(size(lists_.cells) - i.cells, few, [&](Index k) {
      if (view.stays(i.cells + k)) view.use_nodes_of(i.cells + k, use);
    });
    for (Index const c : lists_.converted) view.use_nodes_of(c, use);
    std::vector<Index> found;
    for (Index n = i.nodes; n < lists_.nodes; ++n)
      if (is_used[at(n - i.nodes)] == 0) found.push_back(n);
    return found;
  }

  /// New numbers where some go, as all before `first` is. What goes has −1.
  struct Numbers {
    Index first, count;         // the first that may change; how many there are then
    std::vector<Index> others;  // from `first` on
    std::vector<Index> kept;    // from `first` on: the old numbers of those that stay

    /// Of `end` entries. `gone`: ascending, from `first` on.
    Numbers(Index end, Index first_to_change, std::vector<Index> const& gone)
        : first(first_to_change),
          count(end - size(gone)),
          others(at(end - first)),
          kept(at(count - first)) {
      HostParts const parts(end - first, few);
      parts([&](Index from, Index to, int) {
        auto next = std::ranges::lower_bound(gone, first + from);
        for (Index k = from; k < to;) {
          Index const passed = static_cast<Index>(next - gone.begin());
          Index const until = next == gone.end() ? to : std::min(to, *next - first);
          for (; k < until; ++k) {
            others[at(k)] = first + k - passed;
            kept[at(k - passed)] = first + k;
          }
          if (k == to) break;
          others[at(k++)] = -1;
          ++next;
        }
      });
    }
    [[nodiscard]] NewNumbers view() const { return {first, others.data()}; }
  };

  /// Of the cells before one, those that know of it or of what came with it: that became leaves or lost nodes, were divided since,
  /// or have not the nodes that they had. Each once, ascending.
  [[nodiscard]] std::vector<Index> cells_that_know(std::vector<Index> const& touched,
                                                   Index end) const {
    std::vector<Index> known;
    auto const add = [&](std::vector<Index> const& list, Index from) {
      for (Index const c : list)
        if (c < end && lists_.cells[at(c)].first_child >= from) known.push_back(c);
    };
    constexpr Index any = -1;
    add(touched, any);
    add(lists_.divided, end);
    add(lists_.converted, any);
    return each_once(std::move(known), at(end));
  }
  /// Edges and sides of these cells, and of all from `first_cell` on: those for which is_edge(number) or is_side(number), each once,
  /// ascending.
  template <class IsEdge, class IsSide>
  [[nodiscard]] EdgesAndSides edges_and_sides_of(std::vector<Index> const& cells, Index first_cell,
                                                 IsEdge const& is_edge,
                                                 IsSide const& is_side) const {
    EdgesAndSides found;
    auto const view = lists_.view();
    auto const add = [&](Index c) {
      auto const own = view.row(c);
      auto const& p = view.cells[at(c)].pattern();
      for (std::size_t e = 0; e < at(p.edges); ++e)
        if (is_edge(own.edges[e])) found.edges.push_back(own.edges[e]);
      for (std::size_t s = 0; s < at(p.sides); ++s)
        if (is_side(own.sides[s])) found.sides.push_back(own.sides[s]);
    };
    for (Index const c : cells) add(c);
    for (Index c = first_cell; c < size(lists_.cells); ++c) add(c);
    return {each_once(std::move(found.edges), lists_.edges.size()),
            each_once(std::move(found.sides), lists_.sides.size())};
  }

  /// Those from `first` on move up to their new numbers, and of those before, what the known ones know of others.
  template <class V>
  static void move_up(SharedList<V>& list, std::vector<Index> const& known, Numbers const& numbers,
                      CompactionView const& view) {
    list.edit_listed(known, [&](V& own, auto) { view.renumber_within(own); });
    list.replace_from(at(numbers.first), numbers.kept.size(), [&](std::size_t k) {
      V own = list[at(numbers.kept[k])];
      view.renumber(own);
      return own;
    });
  }

  void move_rows_up(Numbers const& cell, CompactionView const& view) {
    auto const& layout = lists_.layout;
    auto const rows = lists_.rows.pages();
    lists_.rows.replace_from(layout.entry(at(cell.first)), layout.entry(cell.kept.size()),
                             [&](std::size_t i) {
                               auto const row = i >> layout.shift, k = i - layout.entry(row);
                               RowEntry entry = rows[layout.entry(at(cell.kept[row])) + k];
                               view.renumber(entry, static_cast<Index>(k));
                               return entry;
                             });
  }

  TreeLists& lists_;
  bool are_linear_;  // whether all elements have corners only
};

}  // namespace pliant::detail

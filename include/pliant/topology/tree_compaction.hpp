#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Takes away what nothing uses any more after cells of a tree became leaves, or leaves lost the nodes between their corners,
/// on the threads of the host. What the initial mesh has stays, and of it only what refined and converted cells have knows
/// of the rest. Refers to the tree's lists.
class TreeCompaction {
 public:
  explicit TreeCompaction(TreeLists& lists)
      : lists_(lists), node_used_(at(lists.nodes - lists.initial.nodes)) {}

  /// `touched` became leaves or lost their nodes. Children of leaves go.
  Renumbering operator()(std::vector<Index> const& touched) {
    auto const& i = lists_.initial;
    CompactionView view{.tree = lists_.view(), .initial = i};
    find_nodes_in_use(view);
    Numbers node(lists_.nodes, i.nodes, [&](Index n) { return node_used_[at(n - i.nodes)]; }),
        cell(size(lists_.cells), i.cells, [&](Index c) { return view.stays(c); }),
        edge(size(lists_.edges), i.edges,
             [&](Index e) { return CompactionView::is_used(lists_.edges[at(e)]); }),
        side(size(lists_.sides), i.sides,
             [&](Index s) { return CompactionView::is_used(lists_.sides[at(s)]); });
    view.nodes = node.view();
    view.cells = cell.view();
    view.edges = edge.view();
    view.sides = side.view();
    auto known = initial_of(touched);
    auto const divided = initial_of(lists_.divided);
    known.insert(known.end(), divided.begin(), divided.end());
    known.insert(known.end(), lists_.converted.begin(), lists_.converted.end());
    known = each_once(std::move(known), at(i.cells));
    auto const known_edges = lists_.edges_of(known), known_sides = lists_.sides_of(known);
    // Sides look at cells, which are still where they were.
    move_up(lists_.sides, known_sides, side, view);
    move_up(lists_.edges, known_edges, edge, view);
    move_up(lists_.cells, known, cell, view);
    move_rows_up(cell, view);
    for (Index& c : lists_.divided) c = view.cells(c);
    lists_.nodes = node.count;
    return {{i.nodes, std::move(node.others)}, {i.cells, std::move(cell.others)}};
  }

 private:
  static constexpr Index few = 4096;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  void find_nodes_in_use(CompactionView const& view) {
    auto const& i = lists_.initial;
    auto const use_nodes_of = [&](Index c) {
      view.use_nodes_of(c, [&](Index node) {
        std::atomic_ref(node_used_[at(node)]).store(1, std::memory_order_relaxed);
      });
    };
    for_each_on_host(size(lists_.cells) - i.cells, few, [&](Index k) {
      if (view.stays(i.cells + k)) use_nodes_of(i.cells + k);
    });
    std::ranges::for_each(lists_.converted, use_nodes_of);
  }

  /// New numbers of what is used, as all before `first` is. What goes has −1.
  struct Numbers {
    Index first, count;
    std::vector<Index> others;  // from `first` on
    std::vector<Index> kept;    // the old numbers of those that stay

    template <class Used>
    Numbers(Index end, Index begin, Used const& used) : first(begin), others(at(end - begin)) {
      HostParts const parts(end - begin, few);
      std::vector<Index> next(at(parts.count()) + 1);  // of each part
      parts([&](Index from, Index to, int part) {
        Index n = 0;
        for (Index k = from; k < to; ++k) n += (others[at(k)] = used(begin + k) ? 1 : 0);
        next[at(part) + 1] = n;
      });
      std::partial_sum(next.begin(), next.end(), next.begin());
      kept.resize(at(next.back()));
      count = begin + next.back();
      parts([&](Index from, Index to, int part) {
        Index n = next[at(part)];
        for (Index k = from; k < to; ++k) {
          bool const stays = others[at(k)] != 0;
          if (stays) kept[at(n)] = begin + k;
          others[at(k)] = stays ? begin + n++ : -1;
        }
      });
    }
    [[nodiscard]] NewNumbers view() const { return {first, others.data()}; }
  };
  /// Those behind the initial mesh's move up, and the known ones of the initial mesh are told.
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
    std::size_t const per_row = layout.entry(1);
    lists_.rows.replace_from(layout.entry(at(cell.first)), layout.entry(cell.kept.size()),
                             [&](std::size_t i) {
                               auto const old = at(cell.kept[i / per_row]);
                               auto const k = i % per_row;
                               RowEntry entry = lists_.rows[layout.entry(old) + k];
                               view.renumber(entry, static_cast<Index>(k));
                               return entry;
                             });
  }

  [[nodiscard]] std::vector<Index> initial_of(std::vector<Index> cells) const {
    std::erase_if(cells, [&](Index c) { return c >= lists_.initial.cells; });
    return cells;
  }

  TreeLists& lists_;
  std::vector<std::uint8_t> node_used_;  // behind the initial mesh's
};

}  // namespace pliant::detail

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
    find_nodes_in_use();
    auto const& i = lists_.initial;
    Numbers const node(lists_.nodes, i.nodes, [&](Index n) { return is_used(n); }),
        cell(size(lists_.cells), i.cells, [&](Index c) { return stays(c); }),
        edge(size(lists_.edges), i.edges,
             [&](Index e) { return lists_.edges[at(e)].leaves + lists_.edges[at(e)].refined > 0; }),
        side(size(lists_.sides), i.sides,
             [&](Index s) { return lists_.sides[at(s)].any_cell() >= 0; });
    auto known = initial_of(touched);
    auto const divided = initial_of(lists_.divided);
    known.insert(known.end(), divided.begin(), divided.end());
    known.insert(known.end(), lists_.converted.begin(), lists_.converted.end());
    known = each_once(std::move(known), at(i.cells));
    auto const known_edges = lists_.edges_of(known), known_sides = lists_.sides_of(known);

    auto const move = [](Index& number, Numbers const& to) { number = to(number); };
    auto const move_within_side = [&](TreeSide& s) {
      if (std::ranges::none_of(s.cells, [&](Index c) { return c >= 0 && !lists_.is_leaf(c); }))
        s.first_child = s.first_inner_edge = -1;
      move(s.centre, node);
      move(s.first_child, side);
      move(s.first_inner_edge, edge);
      for (Index& c : s.cells) move(c, cell);  // parts of split cells among them
    };
    lists_.sides.edit_listed(known_sides, [&](TreeSide& s, auto) { move_within_side(s); });
    replace(lists_.sides, side, [&](TreeSide s) {
      move_within_side(s);
      move(s.parent, side);
      for (Index& p : s.nodes) move(p, node);
      for (Index& e : s.edges) move(e, edge);
      return s;
    });
    auto const move_within_edge = [&](TreeEdge& e) {
      if (e.refined == 0) e.first_half = -1;
      move(e.middle, node);
      move(e.first_half, edge);
    };
    lists_.edges.edit_listed(known_edges, [&](TreeEdge& e, auto) { move_within_edge(e); });
    replace(lists_.edges, edge, [&](TreeEdge e) {
      move_within_edge(e);
      move(e.parent, edge);
      move(e.side, side);
      move(e.cell, cell);
      for (Index& p : e.nodes) move(p, node);
      return e;
    });
    auto const move_within_cell = [&](TreeCell& c) {
      move(c.first_child, cell);
      move(c.centre, node);
    };
    lists_.cells.edit_listed(known, [&](TreeCell& c, auto) { move_within_cell(c); });
    replace(lists_.cells, cell, [&](TreeCell c) {
      move_within_cell(c);
      move(c.parent, cell);
      for (Index& p : c.nodes) move(p, node);
      for (Index& e : c.edges) move(e, edge);
      for (Index& s : c.sides) move(s, side);
      return c;
    });
    for (Index& c : lists_.divided) move(c, cell);
    lists_.nodes = node.count;
    return {node.list(), cell.list(), i.nodes, i.cells};
  }

 private:
  static constexpr Index few = 4096;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  [[nodiscard]] bool stays(Index c) const {
    return c < lists_.initial.cells || !lists_.is_leaf(lists_.cells[at(c)].parent);
  }
  /// Nodes of the initial mesh are, whatever uses them.
  [[nodiscard]] bool is_used(Index node) const {
    return node < lists_.initial.nodes || node_used_[at(node - lists_.initial.nodes)] != 0;
  }
  void find_nodes_in_use() {
    auto const& i = lists_.initial;
    auto const use_nodes_of = [&](Index c) {
      for (Index const node : lists_.nodes_of(c))
        if (node >= i.nodes)
          std::atomic_ref(node_used_[at(node - i.nodes)]).store(1, std::memory_order_relaxed);
    };
    for_each_on_host(size(lists_.cells) - i.cells, few, [&](Index k) {
      if (stays(i.cells + k)) use_nodes_of(i.cells + k);
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
    Index operator()(Index old) const { return old < first ? old : others[at(old - first)]; }
    [[nodiscard]] std::vector<Index> list() const {
      std::vector<Index> all(at(first));
      std::iota(all.begin(), all.end(), Index{0});
      all.insert(all.end(), others.begin(), others.end());
      return all;
    }
  };
  /// Those behind the initial mesh's move up; moved(entry): an old one as it is then.
  template <class V, class Moved>
  static void replace(SharedList<V>& list, Numbers const& numbers, Moved const& moved) {
    list.replace_from(at(numbers.first), numbers.kept.size(),
                      [&](std::size_t k) { return moved(list[at(numbers.kept[k])]); });
  }

  [[nodiscard]] std::vector<Index> initial_of(std::vector<Index> cells) const {
    std::erase_if(cells, [&](Index c) { return c >= lists_.initial.cells; });
    return cells;
  }

  TreeLists& lists_;
  std::vector<std::uint8_t> node_used_;  // behind the initial mesh's
};

}  // namespace pliant::detail

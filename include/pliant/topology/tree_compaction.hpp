#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Takes away what nothing uses any more after cells of a tree became leaves and their children went, or lost their nodes.
/// What the initial mesh has stays, and of it only what refined and converted cells have knows of the rest. Refers to the tree's lists.
class TreeCompaction {
 public:
  explicit TreeCompaction(TreeLists& lists)
      : lists_(lists),
        node_used_(at(lists.nodes), false),
        edge_used_(lists.edges.size(), true),
        side_used_(lists.sides.size(), true) {}

  /// `touched` became leaves or lost their nodes; `cell_used`: those that did not go.
  Renumbering operator()(std::vector<Index> const& touched, std::vector<bool> const& cell_used) {
    find_nodes_in_use(cell_used);
    forget_what_goes(touched);
    return renumber(cell_used);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  void find_nodes_in_use(std::vector<bool> const& cell_used) {
    auto const& i = lists_.initial;
    std::fill_n(node_used_.begin(), i.nodes, true);
    for (Index c = i.cells; c < size(lists_.cells); ++c)
      if (cell_used[at(c)])
        for (Index const node : lists_.nodes_of(c)) node_used_[at(node)] = true;
    for (Index const c : lists_.converted)
      for (Index const node : lists_.nodes_of(c)) node_used_[at(node)] = true;
  }

  /// References to nodes and parts that nothing uses any more.
  void forget_what_goes(std::vector<Index> const& touched) {
    auto const& i = lists_.initial;
    auto const forget = [&](Index& node) {
      if (node >= 0 && !node_used_[at(node)]) node = -1;
    };
    auto const mend_edge = [&](Index e) {
      auto& edge = lists_.edges.edit(at(e));
      if (edge.refined == 0) edge.first_half = -1;
      forget(edge.middle);
    };
    auto const mend_side = [&](Index s) {
      auto& side = lists_.sides.edit(at(s));
      if (std::ranges::none_of(side.cells, [&](Index c) { return c >= 0 && !lists_.is_leaf(c); }))
        side.first_child = side.first_inner_edge = -1;
      forget(side.centre);
    };
    for (Index const e : lists_.edges_of(initial_of(touched))) mend_edge(e);
    for (Index const s : lists_.sides_of(initial_of(touched))) mend_side(s);
    for (Index const c : touched) forget(lists_.cells.edit(at(c)).centre);
    for (Index e = i.edges; e < size(lists_.edges); ++e) {
      edge_used_[at(e)] = lists_.edges[at(e)].leaves + lists_.edges[at(e)].refined > 0;
      mend_edge(e);
    }
    for (Index s = i.sides; s < size(lists_.sides); ++s) {
      side_used_[at(s)] = lists_.sides[at(s)].cells[0] >= 0;
      mend_side(s);
    }
  }

  /// Moves up what stays.
  Renumbering renumber(std::vector<bool> const& cell_used) {
    auto const& i = lists_.initial;
    Numbers const node(node_used_, i.nodes), cell(cell_used, i.cells), edge(edge_used_, i.edges),
        side(side_used_, i.sides);
    keep(lists_.cells, cell_used, i.cells);
    keep(lists_.edges, edge_used_, i.edges);
    keep(lists_.sides, side_used_, i.sides);
    auto const move = [](Index& number, Numbers const& to) { number = to(number); };
    for (Index& c : lists_.divided) move(c, cell);
    auto const move_within_cell = [&](TreeCell& c) {
      move(c.first_child, cell);
      move(c.centre, node);
    };
    auto const move_within_edge = [&](TreeEdge& e) {
      move(e.middle, node);
      move(e.first_half, edge);
    };
    auto const move_within_side = [&](TreeSide& s) {
      move(s.centre, node);
      move(s.first_child, side);
      move(s.first_inner_edge, edge);
      for (Index& c : s.cells) move(c, cell);  // parts of split cells among them
    };
    auto knowing = initial_of(lists_.divided);
    knowing.insert(knowing.end(), lists_.converted.begin(), lists_.converted.end());
    knowing = each_once(std::move(knowing));
    for (Index const c : knowing) move_within_cell(lists_.cells.edit(at(c)));
    for (Index const e : lists_.edges_of(knowing)) move_within_edge(lists_.edges.edit(at(e)));
    for (Index const s : lists_.sides_of(knowing)) move_within_side(lists_.sides.edit(at(s)));
    for (Index n = i.cells; n < size(lists_.cells); ++n) {
      auto& c = lists_.cells.edit(at(n));
      move_within_cell(c);
      move(c.parent, cell);
      for (Index& p : c.nodes) move(p, node);
      for (Index& e : c.edges) move(e, edge);
      for (Index& s : c.sides) move(s, side);
    }
    for (Index n = i.edges; n < size(lists_.edges); ++n) {
      auto& e = lists_.edges.edit(at(n));
      move_within_edge(e);
      move(e.parent, edge);
      move(e.side, side);
      move(e.cell, cell);
      for (Index& p : e.nodes) move(p, node);
    }
    for (Index n = i.sides; n < size(lists_.sides); ++n) {
      auto& s = lists_.sides.edit(at(n));
      move_within_side(s);
      move(s.parent, side);
      for (Index& p : s.nodes) move(p, node);
      for (Index& e : s.edges) move(e, edge);
    }
    lists_.nodes = node.count;
    return {node.list(), cell.list(), i.nodes, i.cells};
  }
  /// New numbers of what is used, as all before `first` is.
  struct Numbers {
    Index first, count;
    std::vector<Index> others;  // from `first` on

    Numbers(std::vector<bool> const& used, Index begin) : first(begin), count(begin) {
      others.reserve(used.size() - at(first));
      for (std::size_t k = at(first); k < used.size(); ++k)
        others.push_back(used[k] ? count++ : Index{-1});
    }
    Index operator()(Index old) const { return old < first ? old : others[at(old - first)]; }
    [[nodiscard]] std::vector<Index> list() const {
      std::vector<Index> all(at(first));
      std::iota(all.begin(), all.end(), Index{0});
      all.insert(all.end(), others.begin(), others.end());
      return all;
    }
  };
  /// Moves up what is used; all before `first` is.
  template <class V>
  static void keep(SharedList<V>& list, std::vector<bool> const& used, Index first) {
    std::size_t next = at(first);
    for (std::size_t k = next; k < list.size(); ++k)
      if (used[k]) {
        if (next != k) list.edit(next) = list[k];
        ++next;
      }
    list.shrink(next);
  }

  [[nodiscard]] std::vector<Index> initial_of(std::vector<Index> cells) const {
    std::erase_if(cells, [&](Index c) { return c >= lists_.initial.cells; });
    return cells;
  }

  TreeLists& lists_;
  std::vector<bool> node_used_, edge_used_, side_used_;
};

}  // namespace pliant::detail

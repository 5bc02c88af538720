#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/tree_passes.hpp>
#include <pliant/topology/tree_view.hpp>

// Passes that find hanging nodes of trees of one degree, for loops of a backend. See HangingNodes for the rule.
namespace pliant::detail {

/// Nodes with weights, each once, in memory of its own.
struct MasterList {
  static constexpr int most = 64;
  Index nodes[most];
  double weights[most];
  int count = 0;
  bool fits = true;

  PLIANT_HOST_DEVICE void add(Index node, double weight) {
    for (int k = 0; k < count; ++k)
      if (nodes[k] == node) {
        weights[k] += weight;
        return;
      }
    if (count == most) {
      fits = false;
      return;
    }
    nodes[count] = node;
    weights[count++] = weight;
  }
  PLIANT_HOST_DEVICE void remove(int k) {
    --count;
    nodes[k] = nodes[count];
    weights[k] = weights[count];
  }
  PLIANT_HOST_DEVICE void sort() {
    for (int i = 1; i < count; ++i)
      for (int k = i; k > 0 && nodes[k - 1] > nodes[k]; --k) {
        Index const node = nodes[k];
        double const weight = weights[k];
        nodes[k] = nodes[k - 1];
        weights[k] = weights[k - 1];
        nodes[k - 1] = node;
        weights[k - 1] = weight;
      }
  }
};

/// The nodes of a tree that hang on its edges and sides. All leaves are of one degree.
template <int Dim>
struct HangingView {
  TreeView tree;

  /// Whether an edge is a leaf's and bisected for others, and lies on no such edge itself.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_hung_on_edge(Index e) const {
    auto const& own = edge(e);
    if (own.cells.leaves() == 0 || own.first_half < 0) return false;
    for (Index above = own.parent(); above >= 0; above = edge(above).parent())
      if (edge(above).cells.leaves() > 0) return false;
    return true;
  }
  /// Whether a side is a leaf's on one side, and divided on the other.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_hung_on_side(Index s) const {
    auto const& own = side(s);
    return own.first_child >= 0 && own.cells[0] >= 0 && own.cells[1] >= 0 &&
           tree.is_leaf(own.cells[0]) != tree.is_leaf(own.cells[1]);
  }

  /// visit(node, i) for the nodes that hang on such an edge: those on it that the leaf has not.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_edge(Index e, Visit const& visit) const {
    auto const& own = edge(e);
    if (own.is_linear()) return visit(own.middle, 0);
    for (int half = 0; half < 2; ++half)
      if (Index const node = edge(own.first_half + half).middle; node >= 0) visit(node, half);
  }
  PLIANT_HOST_DEVICE void add_masters_on_edge(Index e, int i, double weight,
                                              MasterList& list) const {
    auto const& own = edge(e);
    if (own.is_linear()) {
      list.add(own.nodes[0], weight * 0.5);
      list.add(own.nodes[1], weight * 0.5);
      return;
    }
    double const t = i == 0 ? 0.25 : 0.75;
    list.add(own.nodes[0], weight * ((1 - t) * (1 - 2 * t)));
    list.add(own.middle, weight * (4 * t * (1 - t)));
    list.add(own.nodes[1], weight * (t * (2 * t - 1)));
  }

  /// The same for a side, but for what is on its edges.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_side(Index s, Visit const& visit) const {
    auto const& own = side(s);
    auto const has = nodes_on(own);
    int const n = static_cast<int>(own.corners());
    if (n == 4 && has != CellNodes::all && own.centre >= 0) visit(own.centre, 0);
    if (has == CellNodes::corners) return;
    for (int k = 0; k < n; ++k) {
      if (Index const node = edge(own.first_inner_edge + k).middle; node >= 0) visit(node, 1 + k);
      if (n < 4) continue;
      if (Index const node = side(own.first_child + k).centre; node >= 0) visit(node, 5 + k);
    }
  }
  PLIANT_HOST_DEVICE void add_masters_on_side(Index s, int i, double weight,
                                              MasterList& list) const {
    auto const& own = side(s);
    auto const has = nodes_on(own);
    auto const& p = own.pattern();
    auto const n = own.corners();
    bool const quad = n == 4;
    CellNodeList nodes;
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(tree.corner_of(own, k));
    if (has != CellNodes::corners)
      for (std::size_t k = 0; k < n; ++k) nodes.push_back(edge(own.edges[k]).middle);
    if (has == CellNodes::all && quad) nodes.push_back(own.centre);
    auto const k = static_cast<std::size_t>((i - 1) % 4);  // of i > 0
    auto const& centre = p.place[at(quad ? p.centre : 0)];
    auto const& from = i == 0 ? centre : i < 5 ? p.place[n + k] : p.place[k];
    auto const& to = quad ? centre : p.place[n + (k + n - 1) % n];
    std::array<double, 3> place{centre[0], centre[1], 0.0};
    if (i > 0) place = {(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, 0.0};
    auto const weights =
        shape_weights<Dim>(quad ? CellKind::quadrilateral : CellKind::triangle, has, nodes, place);
    for (std::size_t w = 0; w < weights.size(); ++w)
      list.add(weights[w].first, weight * weights[w].second);
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeEdge const& edge(Index e) const { return tree.edges[at(e)]; }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeSide const& side(Index s) const { return tree.sides[at(s)]; }
  /// The fewest that leaves at a side have.
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodes nodes_on(TreeSide const& own) const {
    auto has = tree.cells[at(own.cells[tree.is_leaf(own.cells[0]) ? 0 : 1])].has;
    for (Index part = own.first_child; part < own.first_child + 4; ++part)
      if (auto const other = tree.cells[at(side(part).any_cell())].has; other < has) has = other;
    return has;
  }
};

/// Edges and sides on which nodes hang, one list behind the other.
template <int Dim>
struct HungOn {
  HangingView<Dim> view;
  Index const *edges, *sides;
  Index edge_count;

  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index k, Visit const& visit_node) const {
    if (k < edge_count)
      view.visit_edge(edges[k], visit_node);
    else
      view.visit_side(sides[k - edge_count], visit_node);
  }
  PLIANT_HOST_DEVICE void add_masters(Index k, int i, double weight, MasterList& list) const {
    if (k < edge_count)
      view.add_masters_on_edge(edges[k], i, weight, list);
    else
      view.add_masters_on_side(sides[k - edge_count], i, weight, list);
  }
  /// How many nodes hang there.
  PLIANT_HOST_DEVICE Index operator()(Index k) const {
    Index count = 0;
    visit(k, [&](Index, int) { ++count; });
    return count;
  }
};

/// Where a slave hangs, and which of the nodes there it is.
struct HangingPlace {
  Index on;
  int which;
};
template <int Dim>
struct ListSlaves {
  HungOn<Dim> hung;
  Index const* start;  // by the edge or side; null: one hangs on each
  std::uint64_t* nodes;
  Index* order;
  HangingPlace* places;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index next = start == nullptr ? k : start[k];
    hung.visit(k, [&](Index node, int which) {
      nodes[next] = static_cast<std::uint64_t>(node);
      order[next] = next;
      places[next++] = {k, which};
    });
  }
};
/// Notes the slaves' numbers, one more, by their nodes; or zero.
struct NumberSlaves {
  std::uint64_t const* nodes;
  Index* slave_at;
  bool any;
  PLIANT_HOST_DEVICE void operator()(Index k) const { slave_at[nodes[k]] = any ? k + 1 : 0; }
};

/// Slaves in the order of their nodes, and their free masters.
template <int Dim>
struct FreeMasters {
  HungOn<Dim> hung;
  Index const* order;
  HangingPlace const* places;
  Index const* slave_at;

  /// All of them are free, or `fits` is false.
  PLIANT_HOST_DEVICE void find(Index k, MasterList& list) const {
    add(k, 1.0, list);
    for (int m = 0; m < list.count && list.fits;) {
      Index const other = slave_at[list.nodes[m]];
      if (other == 0) {
        ++m;
        continue;
      }
      double const weight = list.weights[m];
      list.remove(m);
      add(other - 1, weight, list);
      m = 0;
    }
  }

 private:
  PLIANT_HOST_DEVICE void add(Index k, double weight, MasterList& list) const {
    auto const& place = places[order[k]];
    hung.add_masters(place.on, place.which, weight, list);
  }
};
/// How many each slave has, and how many there are in all.
template <int Dim>
struct CountMasters {
  FreeMasters<Dim> masters;
  Index* stamps;  // by node
  Index now;
  Index* count;     // in all
  Index* too_many;  // set where they do not fit into a list

  PLIANT_HOST_DEVICE Index operator()(Index k) const {
    MasterList list;
    masters.find(k, list);
    if (!list.fits) atomic_store(*too_many, 1);
    for (int m = 0; m < list.count; ++m)
      if (stamps_first(stamps[list.nodes[m]], now)) atomic_add(*count, 1);
    return list.count;
  }
};
/// Fills rows of slaves: nodes and masters by their rows in fields.
template <int Dim, class T>
struct FillSlaves {
  FreeMasters<Dim> masters;
  std::uint64_t const* nodes;
  Index const* row_of_node;
  Index const* first;
  Index *node, *other;
  T* weight;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    MasterList list;
    masters.find(k, list);
    list.sort();
    node[k] = row_of_node[nodes[k]];
    for (int m = 0; m < list.count; ++m) {
      other[first[k] + m] = row_of_node[list.nodes[m]];
      weight[first[k] + m] = static_cast<T>(list.weights[m]);
    }
  }
};

}  // namespace pliant::detail

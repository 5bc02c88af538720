#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/hanging_view.hpp>
#include <pliant/topology/tree_passes.hpp>

// Passes that find hanging nodes, for loops of a backend. See HangingNodes for the rule.
namespace pliant::detail {

/// Edges and sides on which nodes hang, and cells in which they do, one list behind the other.
template <int Dim>
struct HungOn {
  HangingView<Dim> view;
  Index const *edges, *sides, *cells;
  Index edge_count, side_count;

  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index k, Visit const& visit_node) const {
    if (k < edge_count)
      view.visit_edge(edges[k], visit_node);
    else if ((k -= edge_count) < side_count)
      view.visit_side(sides[k], visit_node);
    else
      visit_node(view.tree.cells[static_cast<std::size_t>(cells[k - side_count])].centre, 0);
  }
  PLIANT_HOST_DEVICE void add_masters(Index k, int i, double weight, MasterList& list) const {
    if (k < edge_count)
      view.add_masters_on_edge(edges[k], i, weight, list);
    else if ((k -= edge_count) < side_count)
      view.add_masters_on_side(sides[k], i, weight, list);
    else
      view.add_masters_in_cell(cells[k - side_count], weight, list);
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

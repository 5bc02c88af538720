#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <pliant/body/numbering.hpp>
#include <pliant/topology/topology.hpp>

namespace pliant {

/// The order of the cells of a body's first mesh, by the tree's numbers. That of every mesh it becomes follows from this one and
/// from the tree: children stand in the place of their parents, so that what is near stays near, and no change has to
/// sort a mesh again.
using CellOrder = std::vector<Index>;

template <Element... Es>
CellOrder first_order(Numbering<Es...> const& numbering) {
  CellOrder order;
  for (auto const& elements : numbering.user_element) {
    auto const before = static_cast<Index>(order.size());
    for (Index const e : elements) order.push_back(before + e);
  }
  return order;
}

namespace detail {

/// Calls visit(cell) for each leaf of a tree: cells of the first mesh in their order, children in the place of their parents.
template <int Dim, class Visit>
void for_each_leaf(Hierarchy<Dim> const& tree, CellOrder const& first, Visit const& visit) {
  std::vector<char> is_divided(tree.cells().size(), 0);
  for (Index const c : tree.tree().divided()) is_divided[static_cast<std::size_t>(c)] = 1;
  auto const descend = [&](auto const& self, Index c) -> void {
    if (is_divided[static_cast<std::size_t>(c)] == 0) return visit(c);
    auto const& cell = tree.cell(c);
    for (Index child = 0; child < cell.divided().children; ++child)
      self(self, cell.first_child + child);
  };
  for (Index const c : first)
    if (is_divided[static_cast<std::size_t>(c)] != 0)
      descend(descend, c);
    else
      visit(c);
}

/// Of each type the elements of a topology with a tree, by the user's numbers, in the order that follows from the first
/// mesh's.
template <Element... Es>
std::array<std::vector<Index>, sizeof...(Es)> elements_in_order(
    Topology<Mesh<Es...>> const& topology, CellOrder const& first) {
  // By the cell: the place of its element among those of all types.
  std::vector<Index> place(topology.tree->cells().size(), -1);
  std::array<std::vector<Index>, sizeof...(Es)> elements;
  std::array<Index, sizeof...(Es) + 1> begin{};
  for (std::size_t type = 0; type < elements.size(); ++type) {
    auto const& cells = topology.cells[type];
    for (std::size_t e = 0; e < cells.size(); ++e)
      place[static_cast<std::size_t>(cells[e])] = begin[type] + static_cast<Index>(e);
    begin[type + 1] = begin[type] + static_cast<Index>(cells.size());
    elements[type].resize(cells.size());
  }
  std::array<Index*, sizeof...(Es)> next;
  for (std::size_t type = 0; type < next.size(); ++type) next[type] = elements[type].data();
  for_each_leaf(*topology.tree, first, [&](Index c) {
    Index const own = place[static_cast<std::size_t>(c)];
    std::size_t type = 0;
    while (type + 1 < next.size() && own >= begin[type + 1]) ++type;
    *next[type]++ = own - begin[type];
  });
  return elements;
}

}  // namespace detail

/// The numbering of a topology that a change gave.
template <Element... Es>
Numbering<Es...> numbering_of(Topology<Mesh<Es...>> const& topology, CellOrder const& first) {
  return {topology.mesh, detail::elements_in_order(topology, first)};
}

}  // namespace pliant

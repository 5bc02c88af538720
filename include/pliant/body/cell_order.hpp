#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

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

/// Cells of the first mesh, from which a block of elements is: 40 cubes of six tetrahedra.
inline constexpr Index cells_per_block = 240;

/// The elements of each type by the user's numbers, in the order that a body keeps, and the blocks that they are in.
template <std::size_t Types>
struct OrderedElements {
  std::array<std::vector<Index>, Types> elements;
  std::array<ElementBlocks, Types> blocks;
};

/// The blocks of a first mesh.
template <Element... Es>
std::array<ElementBlocks, sizeof...(Es)> first_blocks(Mesh<Es...> const& mesh) {
  std::array<ElementBlocks, sizeof...(Es)> blocks;
  auto const cells = static_cast<Index>((mesh.template elements<Es>().size() + ... + 0));
  Index before = 0;
  detail::for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    auto const own = static_cast<Index>(mesh.template elements<E>().size());
    for (Index c = 0; c < cells; c += cells_per_block)
      blocks[type].first.push_back(std::clamp(c - before, Index{0}, own));
    blocks[type].first.push_back(own);
    before += own;
  });
  return blocks;
}

/// By the cell of the first mesh, whether other elements stand there than before a change.
template <Element... Es>
std::vector<char> changed_cells(Topology<Mesh<Es...>> const& after, std::size_t cells,
                                Transfer<Mesh<Es...>::dim> const& transfer) {
  std::vector<char> changed(cells, 0);
  for (auto const& family : transfer.families()) {
    auto const& [type, element] = family.after.front();
    Index c = after.cells[type][static_cast<std::size_t>(element)];
    while (after.tree->cell(c).parent >= 0) c = after.tree->cell(c).parent;
    changed[static_cast<std::size_t>(c)] = 1;
  }
  return changed;
}

namespace detail {

/// Calls visit(cell) for each leaf of a tree: cells of the first mesh in their order, children in the place of their
/// parents; and before those of a cell of the first mesh, begin(its place in the order, cell).
template <int Dim, class Begin, class Visit>
void for_each_leaf(Hierarchy<Dim> const& tree, CellOrder const& first, Begin const& begin,
                   Visit const& visit) {
  std::vector<char> is_divided(tree.cells().size(), 0);
  for (Index const c : tree.tree().divided()) is_divided[static_cast<std::size_t>(c)] = 1;
  auto const descend = [&](auto const& self, Index c) -> void {
    if (is_divided[static_cast<std::size_t>(c)] == 0) return visit(c);
    auto const& cell = tree.cell(c);
    for (Index child = 0; child < cell.divided().children; ++child)
      self(self, cell.first_child + child);
  };
  for (std::size_t i = 0; i < first.size(); ++i) {
    Index const c = first[i];
    begin(i, c);
    if (is_divided[static_cast<std::size_t>(c)] != 0)
      descend(descend, c);
    else
      visit(c);
  }
}

}  // namespace detail

/// The elements of a topology with a tree, in the order that follows from the first mesh's. `changed`: as of
/// changed_cells, or empty where it is not known.
template <Element... Es>
OrderedElements<sizeof...(Es)> elements_in_order(Topology<Mesh<Es...>> const& topology,
                                                 CellOrder const& first,
                                                 std::vector<char> const& changed) {
  // By the cell: the place of its element among those of all types.
  std::vector<Index> place(topology.tree->cells().size(), -1);
  OrderedElements<sizeof...(Es)> ordered;
  auto& elements = ordered.elements;
  auto& blocks = ordered.blocks;
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
  detail::for_each_leaf(
      *topology.tree, first,
      [&](std::size_t i, Index root) {
        if (i % cells_per_block == 0)
          for (std::size_t type = 0; type < next.size(); ++type) {
            blocks[type].first.push_back(static_cast<Index>(next[type] - elements[type].data()));
            if (!changed.empty()) blocks[type].stays.push_back(1);
          }
        if (!changed.empty() && changed[static_cast<std::size_t>(root)] != 0)
          for (auto& own : blocks) own.stays.back() = 0;
      },
      [&](Index c) {
        Index const own = place[static_cast<std::size_t>(c)];
        std::size_t type = 0;
        while (type + 1 < next.size() && own >= begin[type + 1]) ++type;
        *next[type]++ = own - begin[type];
      });
  for (std::size_t type = 0; type < next.size(); ++type)
    blocks[type].first.push_back(static_cast<Index>(elements[type].size()));
  return ordered;
}

}  // namespace pliant

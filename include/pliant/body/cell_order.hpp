#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
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
struct CellOrder {
  std::vector<Index> cells;   // in this order
  std::vector<Index> places;  // the inverse

  Index count() const { return static_cast<Index>(cells.size()); }
};

template <Element... Es>
CellOrder first_order(Numbering<Es...> const& numbering) {
  CellOrder order;
  for (auto const& elements : numbering.user_element) {
    Index const before = order.count();
    for (Index const e : elements) order.cells.push_back(before + e);
  }
  order.places.resize(order.cells.size());
  for (Index i = 0; i < order.count(); ++i)
    order.places[static_cast<std::size_t>(order.cells[static_cast<std::size_t>(i)])] = i;
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

/// The same before a change, as a layout keeps it.
template <std::size_t Types>
struct OrderBefore {
  std::array<std::span<Index const>, Types> elements, first;
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

/// By the block, whether other elements stand there than before a change.
template <Element... Es>
std::vector<char> changed_blocks(Topology<Mesh<Es...>> const& after, CellOrder const& first,
                                 Transfer<Mesh<Es...>::dim> const& transfer) {
  std::vector<char> changed(
      static_cast<std::size_t>((first.count() + cells_per_block - 1) / cells_per_block), 0);
  for (auto const& family : transfer.families()) {
    auto const& [type, element] = family.after.front();
    Index c = after.cells[type][static_cast<std::size_t>(element)];
    while (after.tree->cell(c).parent >= 0) c = after.tree->cell(c).parent;
    changed[static_cast<std::size_t>(first.places[static_cast<std::size_t>(c)] / cells_per_block)] =
        1;
  }
  return changed;
}

namespace detail {

/// The places of cells in an ascending list, of which those that are asked for stand near each other or near those of
/// numbers as far apart.
class PlacesOfCells {
 public:
  explicit PlacesOfCells(std::vector<Index> const& cells)
      : cells_(cells), count_(static_cast<Index>(cells.size())) {}

  /// Of a cell that is there.
  Index operator()(Index c) {
    Index const guess = std::clamp(last_ + (c - at(last_)), Index{0}, count_ - 1);
    Index low = guess, high = guess + 1;  // the cell is in [low, high)
    for (Index step = 1; at(low) > c; step *= 2) high = std::exchange(low, std::max(0, low - step));
    for (Index step = 1; high < count_ && at(high) <= c; step *= 2)
      low = std::exchange(high, std::min(count_, high + step));
    auto const found = std::lower_bound(cells_.begin() + low, cells_.begin() + high, c);
    return last_ = static_cast<Index>(found - cells_.begin());
  }

 private:
  Index at(Index place) const { return cells_[static_cast<std::size_t>(place)]; }

  std::vector<Index> const& cells_;
  Index count_, last_ = 0;
};

/// Calls visit(cell) for the leaves in a block of a tree: cells of the first mesh in their order, children in the place of
/// their parents.
template <int Dim, class Visit>
void for_each_leaf(Hierarchy<Dim> const& tree, CellOrder const& first, Index block,
                   Visit const& visit) {
  auto const descend = [&](auto const& self, Index c) -> void {
    auto const& cell = tree.cell(c);
    if (cell.first_child < 0) return visit(c);
    for (Index child = 0; child < cell.divided().children; ++child)
      self(self, cell.first_child + child);
  };
  Index const begin = block * cells_per_block,
              end = std::min(first.count(), begin + cells_per_block);
  for (Index i = begin; i < end; ++i) descend(descend, first.cells[static_cast<std::size_t>(i)]);
}

/// By the old number of each element of a type that stays, its new one.
template <int Dim>
std::vector<Index> new_elements(Transfer<Dim> const& transfer, std::size_t type,
                                std::size_t before) {
  std::vector<Index> now(before, -1);
  Index e = 0;
  for (auto const& origin : transfer.origins(type)) {
    if (origin.child == Transfer<Dim>::Origin::same)
      std::iota(now.begin() + origin.element, now.begin() + origin.element + origin.count, e);
    e += origin.count;
  }
  return now;
}

}  // namespace detail

/// The elements of a topology with a tree, in the order that follows from the first mesh's. `before`: null, or this order
/// before a change, from which blocks that stay are taken by the change's transfer.
template <Element... Es>
OrderedElements<sizeof...(Es)> elements_in_order(
    Topology<Mesh<Es...>> const& topology, CellOrder const& first,
    OrderBefore<sizeof...(Es)> const* before = nullptr,
    Transfer<Mesh<Es...>::dim> const* transfer = nullptr) {
  OrderedElements<sizeof...(Es)> ordered;
  std::vector<char> changed;
  std::array<std::vector<Index>, sizeof...(Es)> now;  // of elements that stay
  std::vector<detail::PlacesOfCells> places(topology.cells.begin(), topology.cells.end());
  if (before != nullptr) changed = changed_blocks(topology, first, *transfer);
  for (std::size_t type = 0; type < now.size(); ++type) {
    ordered.elements[type].reserve(topology.cells[type].size());
    if (before != nullptr)
      now[type] = detail::new_elements(*transfer, type, before->elements[type].size());
  }
  for (Index block = 0; block * cells_per_block < first.count(); ++block) {
    auto const b = static_cast<std::size_t>(block);
    bool const stays = before != nullptr && changed[b] == 0;
    for (std::size_t type = 0; type < now.size(); ++type) {
      auto& elements = ordered.elements[type];
      auto& blocks = ordered.blocks[type];
      blocks.first.push_back(static_cast<Index>(elements.size()));
      if (before != nullptr) blocks.stays.push_back(stays ? 1 : 0);
      if (!stays) continue;
      auto const& cut = before->first[type];
      for (Index const old : before->elements[type].subspan(
               static_cast<std::size_t>(cut[b]), static_cast<std::size_t>(cut[b + 1] - cut[b])))
        elements.push_back(now[type][static_cast<std::size_t>(old)]);
    }
    if (stays) continue;
    detail::for_each_leaf(*topology.tree, first, block, [&](Index c) {
      detail::for_each_type_of(topology.mesh, [&]<Element E>(E, std::size_t type) {
        if (sizeof...(Es) == 1 || detail::is_cell_of<E>(topology.tree->cell(c)))
          ordered.elements[type].push_back(places[type](c));
      });
    });
  }
  for (std::size_t type = 0; type < now.size(); ++type)
    ordered.blocks[type].first.push_back(static_cast<Index>(ordered.elements[type].size()));
  return ordered;
}

}  // namespace pliant

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/element_numbers.hpp>
#include <pliant/body/node_rows.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// Cells of the first mesh, from which a block of elements is.
inline constexpr Index cells_per_block = ElementBlocks::usual;

/// The order of the cells of a body's first mesh, by the tree's numbers. That of every mesh it becomes follows from this one and
/// from the tree: children stand in the place of their parents, so that what is near stays near, and no change has to
/// sort a mesh again.
struct CellOrder {
  std::vector<Index> cells;   // in this order
  std::vector<Index> places;  // the inverse

  Index count() const { return static_cast<Index>(cells.size()); }
  Index blocks() const { return (count() + cells_per_block - 1) / cells_per_block; }
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

/// The elements of each type in the order that a body keeps: the cells that those of each block are, and the blocks.
template <std::size_t Types>
struct OrderedElements {
  std::array<std::vector<std::shared_ptr<BlockCells const>>, Types> cells;
  std::array<ElementBlocks, Types> blocks;
};

/// The same cells before a change, as a layout keeps them (of a first mesh it keeps none), and by the block whether other elements stand there now.
template <std::size_t Types>
struct OrderBefore {
  std::array<std::span<std::shared_ptr<BlockCells const> const>, Types> cells;
  std::span<char const> changed;
};

/// The blocks of a first mesh.
template <Element... Es>
std::array<ElementBlocks, sizeof...(Es)> first_blocks(Mesh<Es...> const& mesh) {
  std::array<ElementBlocks, sizeof...(Es)> blocks;
  auto const cells = static_cast<Index>((mesh.template elements<Es>().size() + ... + 0));
  Index before = 0;
  detail::for_each_type_of<Mesh<Es...>>([&]<Element E>(E, std::size_t type) {
    auto const own = static_cast<Index>(mesh.template elements<E>().size());
    for (Index c = 0; c < cells; c += cells_per_block)
      blocks[type].first.push_back(std::clamp(c - before, Index{0}, own));
    blocks[type].first.push_back(own);
    before += own;
  });
  return blocks;
}

/// The place in the first mesh's order of the cell that each family of a change is a part of.
template <class M>
std::vector<Index> places_of_families(Topology<M> const& after, CellOrder const& first,
                                      Transfer<M::dim> const& transfer) {
  auto const& families = transfer.families();
  std::vector<Index> places(families.size());
  constexpr Index few_families = 1024;  // worth a thread
  detail::for_each_on_host(static_cast<Index>(families.size()), few_families, [&](Index f) {
    auto const& member = families[static_cast<std::size_t>(f)].after.front();
    Index c = after.cells[member.type][static_cast<std::size_t>(member.element)];
    while (after.tree->cell(c).parent >= 0) c = after.tree->cell(c).parent;
    places[static_cast<std::size_t>(f)] = first.places[static_cast<std::size_t>(c)];
  });
  return places;
}
/// By the block, whether a family is in it: other elements stand there than before the change.
inline std::vector<char> changed_blocks(CellOrder const& first,
                                        std::vector<Index> const& places_of_families) {
  std::vector<char> changed(static_cast<std::size_t>(first.blocks()), 0);
  for (Index const place : places_of_families)
    changed[static_cast<std::size_t>(place / cells_per_block)] = 1;
  return changed;
}

namespace detail {

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

}  // namespace detail

/// The elements of a topology with a tree, in the order that follows from the first mesh's. `before`: null, or this order
/// before a change, from which blocks that stay are taken.
template <Element... Es>
OrderedElements<sizeof...(Es)> elements_in_order(
    Topology<Mesh<Es...>> const& topology, CellOrder const& first,
    OrderBefore<sizeof...(Es)> const* before = nullptr) {
  constexpr std::size_t types = sizeof...(Es);
  auto const blocks = static_cast<std::size_t>(first.blocks());
  auto const stays = [&](std::size_t block) {
    return before != nullptr && before->changed[block] == 0;
  };
  auto const is_known = [&](std::size_t block) {
    return stays(block) && std::ranges::all_of(before->cells, [&](auto const& known) {
             return !known.empty() && known[block]->greatest < topology.first_renumbered_cell;
           });
  };
  OrderedElements<types> ordered;
  for (auto& cells : ordered.cells) cells.resize(blocks);
  std::vector<std::size_t> others;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (!is_known(b)) {
      others.push_back(b);
      continue;
    }
    for (std::size_t type = 0; type < types; ++type)
      ordered.cells[type][b] = before->cells[type][b];
  }
  constexpr Index few_blocks = 64;  // worth a thread
  detail::for_each_on_host(static_cast<Index>(others.size()), few_blocks, [&](Index k) {
    auto const b = others[static_cast<std::size_t>(k)];
    std::array<BlockCells, types> own;
    detail::for_each_leaf(*topology.tree, first, static_cast<Index>(b), [&](Index c) {
      detail::for_each_type_of<Mesh<Es...>>([&]<Element E>(E, std::size_t type) {
        if (types == 1 || detail::is_cell_of<E>(topology.tree->cell(c))) own[type].add(c);
      });
    });
    for (std::size_t type = 0; type < types; ++type)
      ordered.cells[type][b] = std::make_shared<BlockCells const>(std::move(own[type]));
  });
  for (std::size_t type = 0; type < types; ++type) {
    auto& cut = ordered.blocks[type].first;
    cut.reserve(blocks + 1);
    cut = {0};
    for (auto const& own : ordered.cells[type])
      cut.push_back(cut.back() + static_cast<Index>(own->cells.size()));
    for (std::size_t b = 0; before != nullptr && b < blocks; ++b)
      ordered.blocks[type].stays.push_back(stays(b) ? 1 : 0);
  }
  return ordered;
}

/// The nodes, by their rows, of a type's elements: of all blocks, or of those that do not stay, one after another.
template <Element E, class M>
std::vector<Connectivity<E>> rows_of_blocks(Topology<M> const& topology,
                                            ElementNumbers::Blocks const& cells,
                                            ElementBlocks const& blocks, bool all,
                                            NodeRows const& node_rows) {
  std::vector<std::size_t> chosen;  // blocks
  std::vector<Index> first{0};      // row, by these
  for (std::size_t b = 0; b < cells.size(); ++b) {
    if (!all && blocks.some_stay() && blocks.stays[b] != 0) continue;
    chosen.push_back(b);
    first.push_back(first.back() + static_cast<Index>(cells[b]->cells.size()));
  }
  std::vector<Connectivity<E>> rows(static_cast<std::size_t>(first.back()));
  constexpr Index few_blocks = 32;  // worth a thread
  detail::for_each_on_host(static_cast<Index>(chosen.size()), few_blocks, [&](Index i) {
    auto const k = static_cast<std::size_t>(i);
    auto row = rows.begin() + first[k];
    for (Index const c : cells[chosen[k]]->cells) {
      *row = topology.template nodes_of_cell<E>(c);
      for (Index& node : *row++) node = node_rows.of_node[static_cast<std::size_t>(node)];
    }
  });
  return rows;
}

}  // namespace pliant

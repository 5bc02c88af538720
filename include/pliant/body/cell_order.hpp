#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/body/touched_elements.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// Cells of the first mesh, from which a block of elements is: 40 cubes of six tetrahedra.
inline constexpr Index cells_per_block = 240;

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

/// The elements of each type by the user's numbers, in the order that a body keeps, and the blocks that they are in.
template <std::size_t Types>
struct OrderedElements {
  std::array<std::vector<Index>, Types> elements;
  std::array<ElementBlocks, Types> blocks;
};

/// The same before a change, as a layout keeps it, what the change means, and by the block whether other elements stand there
/// now.
template <std::size_t Types, int Dim>
struct OrderBefore {
  std::array<std::span<Index const>, Types> elements, first;
  Transfer<Dim> const& transfer;
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

/// What a change means for the blocks: other elements stand in one than before it, or a node of its elements has others
/// around it.
struct ChangedBlocks {
  std::vector<char> elements, nodes;
};

template <Element... Es>
ChangedBlocks changed_blocks(Topology<Mesh<Es...>> const& after, CellOrder const& first,
                             Transfer<Mesh<Es...>::dim> const& transfer,
                             detail::TouchedElements<Mesh<Es...>> const& touched) {
  ChangedBlocks changed;
  changed.elements.resize(static_cast<std::size_t>(first.blocks()), 0);
  auto const block_of = [&](std::size_t type, Index element) {
    Index c = after.cells[type][static_cast<std::size_t>(element)];
    while (after.tree->cell(c).parent >= 0) c = after.tree->cell(c).parent;
    return static_cast<std::size_t>(first.places[static_cast<std::size_t>(c)] / cells_per_block);
  };
  for (auto const& family : transfer.families())
    changed.elements[block_of(family.after.front().type, family.after.front().element)] = 1;
  changed.nodes = changed.elements;
  for (std::size_t type = 0; type < after.cells.size(); ++type)
    for (auto const& element : touched.of_type(type).staying)
      changed.nodes[block_of(type, element.after)] = 1;
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

/// The new numbers of elements of a type that stay.
class NewElements {
 public:
  template <class Origin>
  explicit NewElements(std::vector<Origin> const& origins) {
    Index e = 0;
    for (auto const& origin : origins) {
      if (origin.child == Origin::same)
        runs_.push_back({origin.element, origin.element + origin.count, e - origin.element});
      e += origin.count;
    }
  }
  /// To be asked for elements of which many follow each other.
  auto numbers() const {
    return [this, run = Run{}](Index old) mutable {
      if (old < run.first || old >= run.last)
        run = *(std::ranges::upper_bound(runs_, old, {}, &Run::first) - 1);
      return old + run.shift;
    };
  }

 private:
  struct Run {
    Index first = 0, last = 0, shift = 0;
  };
  std::vector<Run> runs_;
};

}  // namespace detail

/// The elements of a topology with a tree, in the order that follows from the first mesh's. `before`: null, or this order
/// before a change, from which blocks that stay are taken.
template <Element... Es>
OrderedElements<sizeof...(Es)> elements_in_order(
    Topology<Mesh<Es...>> const& topology, CellOrder const& first,
    OrderBefore<sizeof...(Es), Mesh<Es...>::dim> const* before = nullptr) {
  constexpr std::size_t types = sizeof...(Es);
  Index const blocks = first.blocks();
  auto const stays = [&](Index block) {
    return before != nullptr && before->changed[static_cast<std::size_t>(block)] == 0;
  };
  // Those of blocks that do not stay, one after another, and where each block begins.
  std::array<std::vector<Index>, types> own, begin;
  std::vector<detail::PlacesOfCells> places(topology.cells.begin(), topology.cells.end());
  for (Index block = 0; block < blocks; ++block) {
    for (std::size_t type = 0; type < types; ++type)
      begin[type].push_back(static_cast<Index>(own[type].size()));
    if (stays(block)) continue;
    detail::for_each_leaf(*topology.tree, first, block, [&](Index c) {
      detail::for_each_type_of<Mesh<Es...>>([&]<Element E>(E, std::size_t type) {
        if (types == 1 || detail::is_cell_of<E>(topology.tree->cell(c)))
          own[type].push_back(places[type](c));
      });
    });
  }
  OrderedElements<types> ordered;
  for (std::size_t type = 0; type < types; ++type) {
    begin[type].push_back(static_cast<Index>(own[type].size()));
    auto& cut = ordered.blocks[type].first;
    auto& kept = ordered.blocks[type].stays;
    std::optional<detail::NewElements> now;
    if (before != nullptr) now.emplace(before->transfer.origins(type));
    auto const all_of = [&](Index block) {
      auto const b = static_cast<std::size_t>(block);
      auto const part = [b](std::span<Index const> list, std::span<Index const> first_of) {
        return list.subspan(static_cast<std::size_t>(first_of[b]),
                            static_cast<std::size_t>(first_of[b + 1] - first_of[b]));
      };
      return stays(block) ? part(before->elements[type], before->first[type])
                          : part(own[type], begin[type]);
    };
    cut = {0};
    for (Index block = 0; block < blocks; ++block) {
      cut.push_back(cut.back() + static_cast<Index>(all_of(block).size()));
      if (before != nullptr) kept.push_back(stays(block) ? 1 : 0);
    }
    auto& elements = ordered.elements[type];
    elements.resize(static_cast<std::size_t>(cut.back()));
    constexpr Index few_blocks = 64;  // worth a thread
    detail::for_each_on_host(blocks, few_blocks, [&](Index block) {
      auto const to = elements.begin() + cut[static_cast<std::size_t>(block)];
      if (stays(block))
        std::ranges::transform(all_of(block), to, now->numbers());
      else
        std::ranges::copy(all_of(block), to);
    });
  }
  return ordered;
}

}  // namespace pliant

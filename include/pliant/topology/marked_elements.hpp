#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <iterator>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include <pliant/topology/cell_changes.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/shorter_diagonal.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/tree_queries.hpp>

// From marks on elements to changes of the cells that they are.
namespace pliant {

/// Elements of one type by the user's numbers, in the memory of a body's backend.
struct ElementsThere {
  Index const* numbers = nullptr;  ///< (count)
  Index count = 0;

  [[nodiscard]] bool empty() const { return count == 0; }
};

namespace detail {

/// Elements of one type by their numbers, on the host or in a backend's memory.
template <class List>
concept MarkedList = std::same_as<List, std::vector<Index>> || std::same_as<List, ElementsThere>;
/// The same for each element type.
template <MarkedList List>
using ListsOfTypes = std::span<List const>;

/// MarkedElements that stay where they are while these are in use.
template <MarkedList List = std::vector<Index>>
struct MarkedLists {
  ListsOfTypes<List> refine{}, coarsen{}, raise{}, lower{}, split{}, split_in_two{}, merge{};
  int raised_rings = 0;
};

}  // namespace detail

/// Elements to refine, to coarsen, to give a higher or lower degree, to split (quadrilaterals into four triangles, or into
/// two) and to merge: for each element type in the order of the mesh, their numbers. A list of no types marks none.
struct MarkedElements {
  std::vector<std::vector<Index>> refine{}, coarsen{}, raise{}, lower{}, split{}, split_in_two{},
      merge{};
  int raised_rings = 0;  ///< so many rings of neighbours across edges are raised along

  operator detail::MarkedLists<>() const {
    return {refine, coarsen, raise, lower, split, split_in_two, merge, raised_rings};
  }
  bool none() const {
    auto const is_empty = [](auto const& list) {
      return std::ranges::all_of(list, [](auto const& own) { return own.empty(); });
    };
    return is_empty(refine) && is_empty(coarsen) && is_empty(raise) && is_empty(lower) &&
           is_empty(split) && is_empty(split_in_two) && is_empty(merge);
  }
};

namespace detail {

/// The refinement tree of a topology, and for each type the cells that its elements are: those that it has, or those of a first tree.
template <class M>
struct RefinementTree {
  std::shared_ptr<Hierarchy<M::dim> const> tree;
  std::shared_ptr<std::vector<CellSet> const> cells;
};
template <class M>
RefinementTree<M> tree_of(std::shared_ptr<Topology<M> const> const& topology) {
  using Cells = std::shared_ptr<std::vector<CellSet> const>;
  if (topology->tree) return {topology->tree, Cells(topology, &topology->cells)};
  auto const& mesh = topology->mesh();
  if (!mesh.slaves.empty())
    throw Error("refine: the mesh came with ", mesh.slaves.size(),
                " hanging nodes, of which it is not known what was refined; give the coarse mesh, "
                "and refine the body");
  auto cells = std::make_shared<std::vector<CellSet>>();
  Index next = 0;
  for (std::size_t count : element_counts(mesh)) {
    Index const first = next;
    next += static_cast<Index>(count);
    cells->push_back(CellSet::range(first, next));
  }
  return {topology->tree_or_first(), std::move(cells)};
}

/// Throws Error for an element that there is not.
template <Element E>
void check_number(char const* verb, Index element, std::size_t count) {
  if (element < 0 || element >= static_cast<Index>(count))
    throw Error(verb, ": there is no ", E::name(), " element ", element,
                "; they are numbered 0 to ", count - 1);
}

/// The same of many: in a loop that compilers vectorise, of the signs of what is negative for a number that is none.
template <Element E>
void check_numbers(char const* verb, std::span<Index const> elements, std::size_t count) {
  using Bits = std::make_unsigned_t<Index>;
  Bits signs = 0;
  for (Index const e : elements)
    signs |= static_cast<Bits>(e) | (static_cast<Bits>(count) - 1 - static_cast<Bits>(e));
  if (static_cast<Index>(signs) >= 0) return;
  for (Index const e : elements) check_number<E>(verb, e, count);
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <class M>
std::vector<Index> cells_of(RefinementTree<M> const& old, char const* verb,
                            std::vector<std::vector<Index>> const& marked) {
  auto const& cells = *old.cells;
  std::vector<Index> found;
  for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    if (marked.empty()) return;
    for (Index e : marked[type]) {
      check_number<E>(verb, e, cells[type].size());
      found.push_back(cells[type][static_cast<std::size_t>(e)]);
    }
  });
  return found;
}

template <class M>
void check_lists(char const* verb, auto const& marked) {
  constexpr std::size_t types = TypesOf<M>::count;
  if (marked.size() != types)
    throw Error(verb, ": got lists of marked elements for ", marked.size(),
                " element types, but the mesh has ", types,
                "; give one list per type, empty where none is marked");
  if constexpr (std::same_as<std::remove_cvref_t<decltype(marked[0])>, ElementsThere>)
    for (auto const& list : marked)
      if (list.count < 0 || (list.count > 0 && list.numbers == nullptr))
        throw Error(verb, ": got a list of ", list.count,
                    " marked elements in the backend's memory", list.count < 0 ? "" : " at null",
                    "; give the address of as many numbers as are counted");
}

/// Throws Error where elements are marked to be of another degree than `from` that no type of the mesh is of.
template <class M>
void check_conversion(char const* verb, int from, auto const& marked) {
  for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    if (marked.empty() || marked[type].empty()) return;
    if (E::degree != from)
      throw Error(verb, ": ", E::name(), " elements are of degree ", E::degree, "; mark others");
    if (converted_type<E, M> == no_type)
      throw Error(verb, ": the mesh has no element type of another degree on the cell of ",
                  E::name(), "; add one to the types of the mesh, with no elements, and a Group");
  });
}

/// The cells of marked elements that lose the nodes between their corners, each once.
template <class M>
std::vector<Index> lowered_cells(RefinementTree<M> const& old,
                                 std::vector<std::vector<Index>> const& marked) {
  check_conversion<M>("lower", 2, marked);
  return each_once(cells_of(old, "lower", marked), old.tree->cells().size());
}
/// The cells of marked elements and of rings of neighbours that get such nodes, each once.
template <class M>
std::vector<CellConversion> raised_cells(RefinementTree<M> const& old,
                                         std::vector<std::vector<Index>> const& marked, int rings) {
  check_conversion<M>("raise", 1, marked);
  auto cells = each_once(cells_of(old, "raise", marked), old.tree->cells().size());
  for (int ring = 0; ring < rings && !cells.empty(); ++ring)
    cells = TreeQueries(old.tree->tree()).with_neighbours(cells);
  std::vector<CellConversion> raised;
  for (Index const c : cells)
    for_each_type_of<M>([&]<Element E>(E, std::size_t) {
      constexpr std::size_t to = converted_type<E, M>;
      if constexpr (E::degree == 1 && to != no_type)
        if (is_cell_of<E>(old.tree->cell(c)))
          raised.push_back({c, nodes_on_cell<typename ElementOfType<M, to>::type>});
    });
  return raised;
}

/// Of four nodes that run round: see shorter_diagonal.hpp.
template <int Dim>
int shorter_diagonal(Hierarchy<Dim> const& tree, Index const* corners) {
  return shorter_diagonal<Dim>([&](int corner, int k) {
    return tree.points()[static_cast<std::size_t>(corners[corner])][static_cast<std::size_t>(k)];
  });
}

/// Of two pyramids that share a base, along a diagonal of that; nothing where there is no other one.
template <int Dim>
void split_pair(Hierarchy<Dim> const& tree, Index pyramid, std::vector<CellSplit>& splits) {
  Index const other = TreeQueries(tree.tree()).across_base(pyramid);
  if (other < 0 || tree.cell(other).kind != CellKind::pyramid) return;
  auto const& base =
      tree.tree().sides()[static_cast<std::size_t>(tree.tree().row(pyramid).sides[0])];
  auto const corners = tree.tree().lists().view().corners_of(base);
  Index const first = corners[static_cast<std::size_t>(shorter_diagonal(tree, corners.data()))];
  for (Index const c : {pyramid, other}) {
    auto const* const nodes = tree.tree().row(c).nodes;
    splits.push_back(
        {c, nodes[0] == first || nodes[2] == first ? Division::diagonal_0 : Division::diagonal_1});
  }
}

/// Throws Error where elements are marked that cannot be split.
template <class M>
void check_splits(auto const& marked) {
  for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    if (marked.empty() || marked[type].empty()) return;
    if constexpr (std::is_void_v<SplitInto<E>>)
      throw Error("split: ", E::name(),
                  " elements cannot be split; mark Quad4, Hex8 or Pyramid5 elements");
    else if constexpr (!has_type<SplitInto<E>, M>)
      throw Error("split: the mesh has no ", SplitInto<E>::name(), ", into which ", E::name(),
                  " elements are split; add it to the types of the mesh, with no elements, and a "
                  "Group");
  });
}

/// How marked cells are split, ascending; of those that are marked for both, in two.
template <int Dim>
std::vector<CellSplit> splits_of(Hierarchy<Dim> const& tree, std::vector<Index> cells,
                                 std::vector<Index> in_two) {
  in_two = each_once(std::move(in_two), tree.cells().size());
  cells.insert(cells.end(), in_two.begin(), in_two.end());
  std::vector<CellSplit> splits;
  for (Index const c : each_once(std::move(cells), tree.cells().size())) {
    auto const& cell = tree.cell(c);
    if (cell.kind == CellKind::pyramid)
      split_pair(tree, c, splits);
    else if (cell.kind == CellKind::hexahedron)
      splits.push_back({c, Division::six_pyramids});
    else if (!std::ranges::binary_search(in_two, c))
      splits.push_back({c, Division::four_triangles});
    else
      splits.push_back({c, shorter_diagonal(tree, tree.tree().row(c).nodes) == 0
                               ? Division::diagonal_0
                               : Division::diagonal_1});
  }
  // Of pairs that were both marked, each once.
  std::ranges::sort(splits, {}, &CellSplit::cell);
  auto const same = [](CellSplit const& one, CellSplit const& other) {
    return one.cell == other.cell;
  };
  splits.erase(std::unique(splits.begin(), splits.end(), same), splits.end());
  return splits;
}
/// The same of marked elements.
template <class M>
std::vector<CellSplit> split_cells(RefinementTree<M> const& old, MarkedElements const& marked) {
  check_splits<M>(marked.split);
  check_splits<M>(marked.split_in_two);
  return splits_of(*old.tree, cells_of(old, "split", marked.split),
                   cells_of(old, "split", marked.split_in_two));
}

/// The cells that were split into marked ones, all of which are; of two pyramids that share a base both or none.
template <int Dim>
std::vector<Index> merged_splits(Hierarchy<Dim> const& tree, std::vector<Index> const& marked) {
  auto merged = tree.split_cells(marked);
  auto const all = merged;
  std::erase_if(merged, [&](Index c) {
    return tree.cell(c).kind == CellKind::pyramid &&
           !std::ranges::binary_search(all, TreeQueries(tree.tree()).across_base(c));
  });
  return merged;
}
/// Throws Error where elements are marked that nothing is split into.
template <class M>
void check_merges(auto const& marked) {
  for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    if (!is_part<E> && !marked.empty() && !marked[type].empty())
      throw Error("merge: no element is split into ", E::name(),
                  " elements; mark Tri3, Pyramid5 or Tet4 elements");
  });
}

/// What is to become of the cells of a topology by marks on its elements. A family that is merged is not lowered.
template <class M>
CellChanges changes_of(RefinementTree<M> const& old, MarkedElements const& marked) {
  CellChanges changes{.families = old.tree->families(cells_of(old, "coarsen", marked.coarsen)),
                      .refine = cells_of(old, "refine", marked.refine),
                      .lower = lowered_cells(old, marked.lower),
                      .raise = raised_cells(old, marked.raise, marked.raised_rings),
                      .split = split_cells(old, marked)};
  check_merges<M>(marked.merge);
  std::ranges::move(merged_splits(*old.tree, cells_of(old, "merge", marked.merge)),
                    std::back_inserter(changes.families));
  std::ranges::sort(changes.families);
  std::erase_if(changes.lower, [&](Index c) {
    return std::ranges::binary_search(changes.families, old.tree->cell(c).parent);
  });
  return changes;
}

}  // namespace detail

}  // namespace pliant

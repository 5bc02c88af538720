#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include <pliant/topology/cell_changes.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/tree_queries.hpp>

// From marks on elements to changes of the cells that they are.
namespace pliant {

/// Elements to refine, to coarsen, and to give a higher or lower degree: for each element type in the order of the mesh,
/// their numbers. A list of no types marks none.
struct MarkedElements {
  std::vector<std::vector<Index>> refine{}, coarsen{}, raise{}, lower{};
  int raised_rings = 0;  ///< so many rings of neighbours across edges are raised along

  bool none() const {
    auto const empty = [](auto const& list) { return list.empty(); };
    return std::ranges::all_of(refine, empty) && std::ranges::all_of(coarsen, empty) &&
           std::ranges::all_of(raise, empty) && std::ranges::all_of(lower, empty);
  }
};

namespace detail {

/// The refinement tree of a topology, and for each type the cells that its elements are: those that it has, or new ones.
template <class M>
struct RefinementTree {
  std::shared_ptr<Hierarchy<M::dim> const> tree;
  std::vector<std::vector<Index>> cells;
};
template <class M>
RefinementTree<M> tree_of(Topology<M> const& topology) {
  if (topology.tree) return {topology.tree, topology.cells};
  auto const& mesh = topology.mesh;
  if (!mesh.slaves.empty())
    throw Error("refine: the mesh came with ", mesh.slaves.size(),
                " hanging nodes, of which it is not known what was refined; give the coarse mesh, "
                "and refine the body");
  RefinementTree<M> made{std::make_shared<Hierarchy<M::dim>>(mesh), {}};
  Index next = 0;
  for (std::size_t count : element_counts(mesh)) {
    auto& cells = made.cells.emplace_back(count);
    for (Index& c : cells) c = next++;
  }
  return made;
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <class M>
std::vector<Index> cells_of(M const& mesh, std::vector<std::vector<Index>> const& cells,
                            char const* verb, std::vector<std::vector<Index>> const& marked) {
  std::vector<Index> found;
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    if (marked.empty()) return;
    for (Index e : marked[type]) {
      if (e < 0 || e >= static_cast<Index>(cells[type].size()))
        throw Error(verb, ": there is no ", E::name(), " element ", e, "; they are numbered 0 to ",
                    cells[type].size() - 1);
      found.push_back(cells[type][static_cast<std::size_t>(e)]);
    }
  });
  return found;
}

template <class M>
void check_lists(M const& mesh, char const* verb, std::vector<std::vector<Index>> const& marked) {
  std::size_t const types = element_counts(mesh).size();
  if (marked.size() != types)
    throw Error(verb, ": got lists of marked elements for ", marked.size(),
                " element types, but the mesh has ", types,
                "; give one list per type, empty where none is marked");
}

/// Throws Error where elements are marked to be of another degree than `from` that no type of the mesh is of.
template <class M>
void check_conversion(M const& mesh, char const* verb, int from,
                      std::vector<std::vector<Index>> const& marked) {
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
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
std::vector<Index> lowered_cells(M const& mesh, RefinementTree<M> const& old,
                                 std::vector<std::vector<Index>> const& marked) {
  check_conversion(mesh, "lower", 2, marked);
  return each_once(cells_of(mesh, old.cells, "lower", marked));
}
/// The cells of marked elements and of rings of neighbours that get such nodes, each once.
template <class M>
std::vector<CellConversion> raised_cells(M const& mesh, RefinementTree<M> const& old,
                                         std::vector<std::vector<Index>> const& marked, int rings) {
  check_conversion(mesh, "raise", 1, marked);
  auto cells = each_once(cells_of(mesh, old.cells, "raise", marked));
  for (int ring = 0; ring < rings && !cells.empty(); ++ring)
    cells = TreeQueries(old.tree->tree()).with_neighbours(cells);
  std::vector<CellConversion> raised;
  for (Index const c : cells)
    for_each_type_of(mesh, [&]<Element E>(E, std::size_t) {
      constexpr std::size_t to = converted_type<E, M>;
      if constexpr (E::degree == 1 && to != no_type)
        if (is_cell_of<E>(old.tree->cell(c)))
          raised.push_back({c, nodes_on_cell<typename ElementOfType<M, to>::type>});
    });
  return raised;
}

/// What is to become of the cells of a topology by marks on its elements. A family that is merged is not lowered.
template <class M>
CellChanges changes_of(M const& mesh, RefinementTree<M> const& old, MarkedElements const& marked) {
  CellChanges changes{
      .families = old.tree->families(cells_of(mesh, old.cells, "coarsen", marked.coarsen)),
      .refine = cells_of(mesh, old.cells, "refine", marked.refine),
      .lower = lowered_cells(mesh, old, marked.lower),
      .raise = raised_cells(mesh, old, marked.raise, marked.raised_rings)};
  std::erase_if(changes.lower, [&](Index c) {
    return std::ranges::binary_search(changes.families, old.tree->cell(c).parent);
  });
  return changes;
}

}  // namespace detail

}  // namespace pliant

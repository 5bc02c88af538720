#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include <pliant/body/cell_order.hpp>
#include <pliant/body/node_rows_on.hpp>
#include <pliant/topology/hierarchy.hpp>

#include "support/at.hpp"

namespace pliant::test {

/// Values in the memory of a backend, on the host.
template <class B, class U>
std::vector<U> taken(B const& backend, U const* values, Index count) {
  auto array = zeros<U>(backend, at(count));
  detail::copy_values(backend, values, array.data(), at(count));
  return download<U>(array);
}

/// A mesh that is refined and coarsened on the host and in a backend's memory.
template <class B, Element... Es>
struct RefinedMesh {
  using M = Mesh<Es...>;
  B backend;
  Numbering<Es...> numbering;
  CellOrder first;
  std::shared_ptr<Hierarchy<M::dim>> host;
  TreeOn<B> tree;
  LeafOrderOn<B> order;
  NodeRowsOn<B> rows;
  NodeRows rows_before;
  std::vector<Index> leaves_before;
  typename TreeOn<B>::Refined refined{};
  Coarsened coarsened{};
  // Of the last change: new numbers of cells and nodes, and families that were merged.
  Renumbering renumbered;
  std::vector<MergedFamily> families;

  RefinedMesh(B const& on, M const& mesh)
      : backend(on),
        numbering(mesh),
        first(first_order(numbering)),
        host(std::make_shared<Hierarchy<M::dim>>(mesh)),
        tree(backend, host->tree().lists(), *host->tree().cells_at_edges()),
        order(backend, first),
        rows(backend, NodeRows{numbering.internal_node, numbering.user_node, {}}) {}

  void refine(std::vector<Index> const& marked) {
    auto const list = upload(backend, marked);
    note_before();
    refined = tree.refine(list.data(), static_cast<Index>(marked.size()));
    host->refine(marked);
    order.refine(tree, refined);
    rows.extend(tree, order, refined);
    tree.keep();
  }
  /// Merges families of marked leaves; returns how many.
  Index coarsen(std::vector<Index> const& marked) {
    auto const list = upload(backend, marked);
    note_before();
    auto const parents = host->families(marked);
    for (Index const c : parents) {
      auto const& cell = host->cell(c);
      auto const child = std::ranges::find(leaves_before, cell.first_child);
      families.push_back({.first_before = static_cast<Index>(child - leaves_before.begin()),
                          .children = cell.divided().children});
    }
    auto const wanted = host->merge(parents);
    if (!parents.empty()) renumbered = wanted.renumbered;
    coarsened = tree.coarsen(list.data(), static_cast<Index>(marked.size()));
    order.coarsen(tree, coarsened);
    rows.coarsen(coarsened);
    tree.keep();
    auto const now = leaves();
    for (std::size_t r = 0; r < parents.size(); ++r) {
      families[r].cell = renumbered.cells[parents[r]];
      auto const place = std::ranges::find(now, families[r].cell);
      families[r].place = static_cast<Index>(place - now.begin());
    }
    return static_cast<Index>(parents.size());
  }
  std::vector<Index> leaves() const { return taken(backend, order.leaves(), order.count()); }

 private:
  void note_before() {
    rows_before = rows.download_all();
    leaves_before = leaves();
    families.clear();
    renumbered = {};
  }
};

}  // namespace pliant::test

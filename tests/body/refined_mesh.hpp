#pragma once

#include <memory>
#include <vector>

#include <pliant/body/cell_order.hpp>
#include <pliant/body/node_rows_on.hpp>
#include <pliant/topology/hierarchy.hpp>

namespace pliant::test {

inline std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Values in the memory of a backend, on the host.
template <class B, class U>
std::vector<U> taken(B const& backend, U const* values, Index count) {
  auto array = zeros<U>(backend, at(count));
  detail::copy_values(backend, values, array.data(), at(count));
  return download<U>(array);
}

/// A mesh that is refined on the host and in a backend's memory.
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
    rows_before = rows.download_all();
    leaves_before = leaves();
    refined = tree.refine(list.data(), static_cast<Index>(marked.size()));
    host->refine(marked);
    order.refine(tree, refined);
    rows.refine(tree, order, refined);
    tree.keep();
  }
  std::vector<Index> leaves() const { return taken(backend, order.leaves(), order.count()); }
};

}  // namespace pliant::test

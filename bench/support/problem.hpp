#pragma once

#include <map>
#include <memory>

#include <pliant/body/numbering.hpp>

#include "support/backends.hpp"
#include "support/meshes.hpp"

namespace pliant::bench {

/// A mesh in the order of a body.
template <Element E>
struct OrderedMesh {
  Mesh<E> mesh;
  Numbering<E> numbering;

  explicit OrderedMesh(Mesh<E> of) : mesh(std::move(of)), numbering(mesh) {}
  explicit OrderedMesh(int cells) : OrderedMesh(mesh_of<E>(cells)) {}

  /// The one asked for last is kept: precisions follow each other.
  static OrderedMesh const& of(int cells) {
    static std::unique_ptr<OrderedMesh> last;
    static int last_cells = 0;
    if (last_cells != cells) {
      last.reset();
      last = std::make_unique<OrderedMesh>(cells);
      last_cells = cells;
    }
    return *last;
  }
};

/// What element loops work on, with no body around it, so that one serves all laws.
template <Backend B, Element E>
struct Problem {
  using T = typename B::scalar;
  static constexpr int dim = E::dim;
  template <class U>
  using Array = typename B::template Array<U>;
  using ConstField = NodeField<T const, dim>;

  Index nodes;
  typename B::template Elements<E::nodes> elements;
  Array<T> rest_values, u_values, du_values, f_values;  // (nodes, 4); f with scratch rows behind

  Problem(B const& backend, OrderedMesh<E> const& ordered)
      : nodes(static_cast<Index>(ordered.mesh.nodes.size())),
        elements(backend, std::get<0>(ordered.numbering.tables), 1,
                 std::vector<Tag>(std::get<0>(ordered.numbering.tables).size(), 0), nodes,
                 node_order<E>),
        rest_values(upload(backend, padded(ordered, ordered.mesh.nodes))),
        u_values(upload(backend, padded(ordered, shaken(ordered.mesh.nodes, 1)))),
        du_values(upload(backend, padded(ordered, shaken(ordered.mesh.nodes, 2)))),
        f_values(zeros<T>(
            backend, node_stride * static_cast<std::size_t>(nodes + elements.scratch_nodes()))) {}

  ConstField rest() const { return {rest_values.data()}; }
  ConstField u() const { return {u_values.data()}; }
  ConstField du() const { return {du_values.data()}; }
  NodeField<T, dim> f() { return {f_values.data()}; }
  void clear_forces(B const& backend) { backend.for_each(nodes, Clear<T>{f_values.data()}); }

  /// Made when it is first asked for, kept until the program ends.
  static Problem& of(B const& backend, int cells) {
    static std::map<int, Problem> made;
    auto const found = made.find(cells);
    if (found != made.end()) return found->second;
    return made.try_emplace(cells, backend, OrderedMesh<E>::of(cells)).first->second;
  }

 private:
  static std::vector<T> padded(OrderedMesh<E> const& ordered,
                               std::vector<Point<dim>> const& values) {
    std::vector<T> rows(node_stride * values.size(), T(0));
    for (std::size_t i = 0; i < values.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        rows[node_stride * static_cast<std::size_t>(ordered.numbering.internal_node[i]) + k] =
            static_cast<T>(values[i][k]);
    return rows;
  }
};

}  // namespace pliant::bench

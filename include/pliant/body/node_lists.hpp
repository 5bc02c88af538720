#pragma once

#include <cstddef>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/body/exact_sum.hpp>
#include <pliant/body/node_rows.hpp>
#include <pliant/body/when_asked.hpp>
#include <pliant/topology/shared_list.hpp>

namespace pliant {

/// What the host knows of the nodes of a layout: their rows and masses. Where the mesh is changed in the backend's memory, the
/// host makes the lists when they are asked for.
template <Backend B>
class NodeLists {
 public:
  using Numbers = typename B::template Array<Index>;

  NodeLists() = default;
  /// `own_masses`, `mass_list`: see below. `user_nodes`: by row, in the backend's memory; empty: made when it is asked for.
  NodeLists(Index nodes, WhenAsked<NodeRows> rows,
            WhenAsked<SharedList<detail::ExactSum>> own_masses,
            WhenAsked<SharedList<double>> mass_list, Numbers user_nodes)
      : nodes_(nodes),
        rows_(std::move(rows)),
        own_masses_(std::move(own_masses)),
        mass_list_(std::move(mass_list)),
        user_nodes_(std::move(user_nodes)) {}

  /// How many nodes the mesh has.
  Index nodes() const { return nodes_; }
  NodeRows const& node_rows() const { return *rows_; }
  WhenAsked<NodeRows> const& node_rows_when_asked() const { return rows_; }
  /// Sums of the nodes' lumped masses in the user's order, slaves' with them.
  SharedList<detail::ExactSum> const& own_masses() const { return *own_masses_; }
  /// The same in kg, slaves' handed on.
  SharedList<double> const& mass_list() const { return *mass_list_; }
  /// The user's numbers of nodes by the row, in the backend's memory; −1: the row is free.
  Numbers const& user_nodes_on(B const& backend) const {
    if (user_nodes_.size() == 0) user_nodes_ = upload(backend, node_rows().node);
    return user_nodes_;
  }
  /// The row of a node by the user's number.
  Index internal_of(Index user) const {
    return node_rows().of_node[static_cast<std::size_t>(user)];
  }
  /// The inverse.
  Index user_of(Index row) const { return node_rows().node[static_cast<std::size_t>(row)]; }

 protected:
  void set_rows(NodeRows rows) {
    nodes_ = static_cast<Index>(rows.of_node.size());
    rows_ = std::move(rows);
  }
  void set_masses(SharedList<detail::ExactSum> own, SharedList<double> list) {
    own_masses_ = std::move(own);
    mass_list_ = std::move(list);
  }

 private:
  Index nodes_ = 0;
  WhenAsked<NodeRows> rows_;
  WhenAsked<SharedList<detail::ExactSum>> own_masses_;
  WhenAsked<SharedList<double>> mass_list_;
  mutable Numbers user_nodes_;
};

}  // namespace pliant

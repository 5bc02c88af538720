#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/error.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/transfer.hpp>
#include <pliant/topology/tree_on.hpp>

// What becomes of nodes in a change of a mesh, for values of nodes in a backend's memory.
namespace pliant {

namespace detail {

/// Nodes of a mesh that was changed in a backend's memory: those that stay, and behind them those that a refinement made.
template <Backend B>
struct ChangedNodesOn {
  Index before = 0, now = 0;  // how many there were, and are
  Index first_moved = 0;      // the first that may have another number or be gone
  std::shared_ptr<typename B::template Array<Index>>
      numbers{};    // from that one on; null: all keep theirs
  TreeView tree{};  // with the new nodes
  typename TreeOn<B>::Refined refined{};

  [[nodiscard]] NewNumbers new_numbers() const {
    return {numbers ? first_moved : before, numbers ? numbers->data() : nullptr};
  }
};

/// Gives nodes that stay the values that they had.
template <class U>
struct MoveNodeValues {
  NewNumbers numbers;
  std::ptrdiff_t components;
  U const* before;
  U* now;
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    Index const to = numbers(node);
    if (to < 0) return;
    for (std::ptrdiff_t c = 0; c < components; ++c)
      now[components * to + c] = before[components * node + c];
  }
};
/// Gives a new node the weighted sums of the values that the nodes have that its cell had: see Transfer::fill_new_nodes.
template <Element E, class U>
struct CarryNewNodes {
  TreeView tree;
  PlacedNode const* nodes;
  bool has_others;  // whether they may lie in cells of other kinds
  std::ptrdiff_t components;
  U* values;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    PlacedNode const& placed = nodes[k];
    if (has_others &&
        tree.cells[static_cast<std::size_t>(placed.cell)].kind != kind_of<typename E::cell>)
      return;
    Vector<double, E::dim> xi;
    for (int d = 0; d < E::dim; ++d) xi[d] = placed.place[static_cast<std::size_t>(d)];
    auto const weights = E::shape(xi);
    auto const parents = tree.nodes_of(placed.cell);
    for (std::ptrdiff_t c = 0; c < components; ++c) {
      U first{};
      Uncontracted sum = 0.0;
      bool same = true, none = true;  // what all have is not rounded
      for (int a = 0; a < E::nodes; ++a) {
        if (weights[a] == 0) continue;
        U const value = values[components * parents[static_cast<std::size_t>(a)] + c];
        if (none) first = value;
        none = false;
        same = same && value == first;
        sum += Uncontracted(weights[a]) * Uncontracted(value);
      }
      values[components * placed.node + c] = same ? first : static_cast<U>(sum.value);
    }
  }
};

}  // namespace detail

/// A change of a mesh, as listeners of Body::on_backend_change get it, who keep values of nodes in the backend's memory, by the
/// user's numbers. Valid during the call.
template <class M, Backend B>
class BackendChange {
 public:
  template <class U>
  using Array = typename B::template Array<U>;

  /// One that the host made.
  BackendChange(B const& backend, Transfer<M::dim> const& transfer)
      : backend_(backend), transfer_(&transfer) {}
  /// One that was made in the backend's memory.
  BackendChange(B const& backend, detail::ChangedNodesOn<B> const& nodes)
      : backend_(backend), nodes_(&nodes) {}

  [[nodiscard]] Index nodes_before() const {
    return nodes_ != nullptr ? nodes_->before : transfer_->old_nodes();
  }
  [[nodiscard]] Index nodes() const { return nodes_ != nullptr ? nodes_->now : transfer_->nodes(); }

  /// Values of nodes on the new mesh, as Transfer::carry_nodes gives them: `now`, (nodes(), components), of `before`,
  /// (nodes_before(), components), floating-point numbers in the backend's memory. Waits for the backend only where the host made
  /// the change. Throws Error for less than one component.
  template <class U>
  void carry_nodes(U const* before, U* now, int components = 1) const {
    if (components < 1)
      throw Error("carry_nodes: ", components, " components; give how many each node has");
    if (nodes_ != nullptr)
      carry_there(before, now, components);
    else
      carry_by_host(before, now, at(components));
  }
  /// The same of an array. Throws Error, too, for one that is not of the mesh before.
  template <class U>
  [[nodiscard]] Array<U> carry_nodes(Array<U> const& before, int components = 1) const {
    auto const wanted = at(nodes_before()) * at(components);
    if (before.size() != wanted)
      throw Error("carry_nodes: got ", before.size(),
                  " values of nodes, but those before the change take ", wanted,
                  "; give the array from before it");
    auto now = unset<U>(backend_, at(nodes()) * at(components));
    carry_nodes(before.data(), now.data(), components);
    return now;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  template <class U>
  void carry_there(U const* before, U* now, int components) const {
    auto const numbers = nodes_->new_numbers();
    backend_.for_each(nodes_->before, detail::MoveNodeValues<U>{numbers, components, before, now});
    fill_new_nodes(static_cast<M*>(nullptr), now, components);
  }
  template <Element... Es, class U>
  void fill_new_nodes(Mesh<Es...>*, U* values, int components) const {
    auto const& refined = nodes_->refined;
    (backend_.for_each(refined.new_nodes,
                       detail::CarryNewNodes<Es, U>{nodes_->tree, refined.nodes, sizeof...(Es) > 1,
                                                    components, values}),
     ...);
  }

  template <class U>
  void carry_by_host(U const* before, U* now, std::size_t components) const {
    auto own = unset<U>(backend_, at(nodes_before()) * components);
    detail::copy_values<B, U>(backend_, before, own.data(), own.size());
    auto const all = download<U>(own);
    std::vector<U> carried(at(nodes()) * components);
    for (std::size_t c = 0; c < components; ++c) {
      std::vector<U> values(at(nodes_before()));
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = all[components * i + c];
      values = transfer_->carry_nodes(std::move(values));
      for (std::size_t i = 0; i < values.size(); ++i) carried[components * i + c] = values[i];
    }
    own = upload(backend_, carried);
    detail::copy_values<B, U>(backend_, own.data(), now, carried.size());
  }

  B const& backend_;
  Transfer<M::dim> const* transfer_ = nullptr;
  detail::ChangedNodesOn<B> const* nodes_ = nullptr;
};

}  // namespace pliant

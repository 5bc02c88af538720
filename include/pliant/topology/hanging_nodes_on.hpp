#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/constraint/interpolation_on.hpp>
#include <pliant/constraint/rows_on.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/hanging_degrees.hpp>
#include <pliant/topology/hanging_lists.hpp>
#include <pliant/topology/hanging_passes.hpp>
#include <pliant/topology/stamps.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

/// Finds the nodes that hang in a tree in a backend's memory, as HangingNodes does on the host.
template <int Dim, Backend B>
class HangingNodesOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// `sides_have_nodes`: whether nodes may hang in the middle of sides; not where all sides are those of linear tetrahedra.
  explicit HangingNodesOn(B const& backend, bool sides_have_nodes = true)
      : backend_(backend), sides_have_nodes_(sides_have_nodes), counts_(backend, 6) {}

  /// Every one, ascending by the user's numbers, with its free masters; by row_of_node(the user's number), in the backend's
  /// memory.
  RowsOn<B> rows(TreeOn<B> const& tree, Index const* row_of_node) {
    find(tree);
    return rows_waited_for(tree, row_of_node);
  }
  /// The same after a change of the tree of which the last call told, by a refinement or a coarsening (TreeOn::Refined, Coarsened).
  template <class Change>
  RowsOn<B> rows_after(TreeOn<B> const& tree, Change const& change, Index const* row_of_node) {
    find_after(tree, change);
    return rows_waited_for(tree, row_of_node);
  }

  // The same in three calls, between each two of which the backend has to be waited for, so that other work may stand there.

  /// Asks for the edges and sides on which nodes hang, and the cells in which they do.
  void find(TreeOn<B> const& tree) {
    counts_.set_all(0);
    knows_all_ = !tree.mixes_degrees();
    if (!knows_all_) return find_of_degrees(tree);
    detail::HangingView<Dim> const view{tree.view()};
    select(tree.sizes().edges, detail::IsHungOnEdge<Dim>{view}, edges_, edges_at);
    select(sides_of(tree), detail::IsHungOnSide<Dim>{view}, sides_, sides_at);
  }
  /// The same after a refinement: looks at what hung before it, and at what was refined. `beside`: steps of other loops (in_turn).
  template <class... Steps>
  void find_after(TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined,
                  Steps const&... beside) {
    if (!knows_all_ || tree.mixes_degrees()) return find_beside(tree, beside...);
    using detail::LoopStep, detail::CopyValue, detail::FillValue, detail::IsHungOnEdge,
        detail::IsHungOnSide, detail::ListStillHung;
    using NewEdges = detail::ListNewlyHungEdges<Dim>;
    using NewSides = detail::ListNewlyHungSides<Dim>;
    detail::HangingView<Dim> const view{tree.view()};
    Index const new_edges = NewEdges::each * refined.leaves,
                new_sides = sides_have_nodes_ ? NewSides::each * refined.leaves : 0;
    make_room(new_edges, new_sides);
    Index *const edges = counters_.data(), *const sides = edges + 1;
    detail::in_turn(
        backend_, beside..., LoopStep{2, FillValue<Index>{edges, 0}},
        LoopStep{
            edge_count_,
            ListStillHung<IsHungOnEdge<Dim>>{{view}, edges_before_.data(), edges_.data(), edges}},
        LoopStep{
            side_count_,
            ListStillHung<IsHungOnSide<Dim>>{{view}, sides_before_.data(), sides_.data(), sides}},
        LoopStep{new_edges, NewEdges{{view}, refined.cells, refined.parts, edges_.data(), edges}},
        LoopStep{new_sides, NewSides{{view}, refined.cells, refined.parts, sides_.data(), sides}},
        LoopStep{2, CopyValue<Index>{edges, counts_.data()}});
  }
  /// The same after a coarsening. Only leaves that were made of families come to have finer neighbours: what else hangs did so
  /// before.
  template <class... Steps>
  void find_after(TreeOn<B> const& tree, Coarsened const& coarsened, Steps const&... beside) {
    if (!knows_all_ || tree.mixes_degrees()) return find_beside(tree, beside...);
    if (coarsened.merged == 0) return detail::in_turn(backend_, beside...);
    using detail::LoopStep, detail::CopyValue, detail::FillValue, detail::IsHungOnEdge,
        detail::IsHungOnSide, detail::ListStaying, detail::NewNumbers;
    using EdgesOfMerged = detail::ListHungEdgesOfMerged<Dim>;
    using SidesOfMerged = detail::ListHungSidesOfMerged<Dim>;
    detail::HangingView<Dim> const view{tree.view()};
    auto const& staying = coarsened.staying;
    NewNumbers const cells{staying.cells, coarsened.cells};
    Index const of_edges = EdgesOfMerged::each * coarsened.merged,
                of_sides = sides_have_nodes_ ? SidesOfMerged::each * coarsened.merged : 0;
    make_room(of_edges, of_sides);
    edge_stamps_.begin(backend_, at(coarsened.now.edges));
    side_stamps_.begin(backend_, sides_have_nodes_ ? at(coarsened.now.sides) : 0);
    detail::ListOnce const edges{edge_stamps_.data(), edge_stamps_.now(), edges_.data(),
                                 counters_.data()},
        sides{side_stamps_.data(), side_stamps_.now(), sides_.data(), counters_.data() + 1};
    detail::in_turn(
        backend_, beside..., LoopStep{2, FillValue<Index>{counters_.data(), 0}},
        LoopStep{edge_count_,
                 ListStaying<IsHungOnEdge<Dim>>{
                     {view}, edges_before_.data(), {staying.edges, coarsened.edges}, edges}},
        LoopStep{side_count_,
                 ListStaying<IsHungOnSide<Dim>>{
                     {view}, sides_before_.data(), {staying.sides, coarsened.sides}, sides}},
        LoopStep{of_edges, EdgesOfMerged{{view}, coarsened.parents, cells, edges}},
        LoopStep{of_sides, SidesOfMerged{{view}, coarsened.parents, cells, sides}},
        LoopStep{2, CopyValue<Index>{counters_.data(), counts_.data()}});
  }
  /// How many edges, sides and cells were found.
  [[nodiscard]] Index count_found() const {
    auto const found = counts_.template first<3>();
    return found[edges_at] + found[sides_at] + found[cells_at];
  }
  /// Numbers the slaves, and asks how many masters they have.
  void find_masters(TreeOn<B> const& tree) {
    Index const places = count_found(), nodes = tree.sizes().nodes;
    auto const found = counts_.template first<2>();
    edge_count_ = found[edges_at];
    side_count_ = found[sides_at];
    auto const hung = hung_on(tree);
    std::swap(nodes_, nodes_before_);
    if (slave_at_.size() < at(nodes)) {
      slave_at_ = zeros<Index>(backend_, at(nodes) + at(nodes) / 2);
      slaves_ = 0;
    }
    auto const forget = number_slaves(nodes_before_, std::exchange(slaves_, 0), false);
    // One hangs on each edge where all leaves have corners only.
    bool const mixes = tree.mixes_degrees(),
               is_one_each = tree.is_linear() && !mixes && side_count_ == 0;
    Index n = is_one_each ? places : count_on(hung, places);
    if (n == 0) return forget.run(backend_);
    need(nodes_, n);
    need(order_, n);
    need(places_, n);
    detail::LoopStep const listing{
        places, detail::ListSlaves<Dim>{hung, is_one_each ? nullptr : start_.data(), nodes_.data(),
                                        order_.data(), places_.data()}};
    detail::SortStep const sorting{n, nodes_.data(), order_.data(), detail::key_bits(nodes)};
    if (mixes) {
      detail::in_turn(backend_, listing, sorting);
      n = once_.keep(backend_, n, nodes_, order_);
    }
    first_ = unset<Index>(backend_, at(n) + 1);
    need(counters_, 2);
    node_stamps_.begin(backend_, at(nodes));
    auto const count_masters = [&](auto const&... before) {
      Index *const masters = counters_.data(), *const too_many = masters + 1;
      detail::in_turn(
          backend_, forget, detail::LoopStep{2, detail::FillValue<Index>{masters, 0}}, before...,
          number_slaves(nodes_, n, true),
          detail::ScanStep{n,
                           detail::CountMasters<Dim>{free_masters(tree), node_stamps_.data(),
                                                     node_stamps_.now(), masters, too_many},
                           first_.data()},
          detail::LoopStep{2, detail::CopyValue<Index>{masters, counts_.data() + masters_at}},
          detail::LoopStep{1,
                           detail::CopyValue<Index>{first_.data() + n, counts_.data() + sum_at}});
    };
    if (mixes)
      count_masters();
    else
      count_masters(listing, sorting);
    slaves_ = n;
  }
  /// The interpolation by what was found. `rows`: a number that those of nodes are below.
  InterpolationOn<B> interpolation(TreeOn<B> const& tree, Index const* row_of_node, Index rows) {
    auto slaves = room_for_slaves();
    auto const fill = filling(tree, row_of_node, slaves);
    return {backend_, std::move(slaves), !tree.is_linear(), rows, fill};
  }

 private:
  /// Where counts stand: of edges, sides and cells found; of masters, and behind that whether they are too many; a sum.
  enum : std::size_t { edges_at, sides_at, cells_at, masters_at, sum_at = masters_at + 2 };

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  void need(auto& array, Index count) { detail::grow(backend_, array, at(count)); }
  RowsOn<B> rows_waited_for(TreeOn<B> const& tree, Index const* row_of_node) {
    backend_.synchronize();
    find_masters(tree);
    backend_.synchronize();
    auto slaves = room_for_slaves();
    filling(tree, row_of_node, slaves).run(backend_);
    return slaves;
  }
  /// For so many more than there were.
  void make_room(Index edges, Index sides) {
    std::swap(edges_, edges_before_);
    std::swap(sides_, sides_before_);
    need(edges_, edge_count_ + edges);
    need(sides_, side_count_ + sides);
    need(counters_, 2);
  }
  void find_beside(TreeOn<B> const& tree, auto const&... steps) {
    detail::in_turn(backend_, steps...);
    find(tree);
  }
  [[nodiscard]] Index sides_of(TreeOn<B> const& tree) const {
    return sides_have_nodes_ ? tree.sizes().sides : 0;
  }
  /// Asks for the i < n that are wanted, and for how many there are.
  template <class Wanted>
  void select(Index n, Wanted const& wanted, Array<Index>& list, std::size_t count) {
    if (n == 0) return;
    need(list, n);
    backend_.select(n, wanted, list.data(), counts_.data() + count);
  }
  /// The same as find, of a tree that mixes degrees. Waits.
  void find_of_degrees(TreeOn<B> const& tree) {
    auto const sizes = tree.sizes();
    Index const sides = sides_of(tree);
    auto const hung = linear_.find(backend_, tree.view(), sizes.edges, sides);
    select(sizes.edges, detail::IsHungOnAnyEdge<Dim>{hung}, edges_, edges_at);
    select(sides, detail::IsHungOnAnySide<Dim>{hung}, sides_, sides_at);
    select(sizes.cells, detail::IsHungInCell{tree.view()}, cells_, cells_at);
  }
  /// Rows of what was found, without values.
  RowsOn<B> room_for_slaves() {
    if (slaves_ == 0) return {};
    auto const counts = counts_.template first<6>();
    auto const masters = counts[masters_at], entries = counts[sum_at];
    if (counts[masters_at + 1] != 0)
      throw Error("hanging nodes: one has more than ", detail::MasterList::most,
                  " masters; keep neighbours of finer elements within one level");
    return {slaves_,
            unset<Index>(backend_, at(slaves_)),
            std::move(first_),
            unset<Index>(backend_, at(entries)),
            unset<T>(backend_, at(entries)),
            masters};
  }
  detail::LoopStep<detail::FillSlaves<Dim, T>> filling(TreeOn<B> const& tree,
                                                       Index const* row_of_node,
                                                       RowsOn<B>& rows) const {
    return {rows.count,
            {free_masters(tree), nodes_.data(), row_of_node, rows.first.data(), rows.node.data(),
             rows.other.data(), rows.weight.data()}};
  }
  [[nodiscard]] detail::HungOn<Dim> hung_on(TreeOn<B> const& tree) const {
    return {{tree.view(), tree.mixes_degrees() ? linear_.data() : nullptr},
            edges_.data(),
            sides_.data(),
            cells_.data(),
            edge_count_,
            side_count_};
  }
  [[nodiscard]] detail::FreeMasters<Dim> free_masters(TreeOn<B> const& tree) const {
    return {hung_on(tree), order_.data(), places_.data(), slave_at_.data()};
  }
  /// Numbers listed slaves, or forgets their numbers.
  detail::LoopStep<detail::NumberSlaves> number_slaves(Array<std::uint64_t> const& nodes,
                                                       Index count, bool are_known) {
    return {count, {nodes.data(), slave_at_.data(), are_known}};
  }
  /// How many nodes hang on edges and sides, and before each of these.
  Index count_on(detail::HungOn<Dim> const& hung, Index places) {
    need(start_, places + 1);
    detail::in_turn(backend_, detail::ScanStep{places, hung, start_.data()},
                    detail::LoopStep{1, detail::CopyValue<Index>{start_.data() + places,
                                                                 counts_.data() + sum_at}});
    backend_.synchronize();
    return counts_.template first<6>()[sum_at];
  }

  B backend_;
  bool sides_have_nodes_, knows_all_ = false;
  Array<Index> edges_, sides_, cells_;    // where nodes hang, in no order
  detail::LinearEdgesOn<Dim, B> linear_;  // of a tree that mixes degrees
  Index edge_count_ = 0, side_count_ = 0;
  Array<Index> edges_before_, sides_before_;
  detail::Stamps<B> edge_stamps_, side_stamps_, node_stamps_;
  Array<Index> start_, order_, first_, counters_;
  ReadBack<B, Index> counts_;
  Array<std::uint64_t> nodes_, nodes_before_;  // slaves, and those before
  detail::SlavesOnce<B> once_;                 // of a tree that mixes degrees
  Array<detail::HangingPlace> places_;
  Array<Index> slave_at_;  // by node: its number among slaves, one more; or zero
  Index slaves_ = 0;       // how many are numbered there
};

}  // namespace pliant

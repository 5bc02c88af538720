#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/is_marked.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/facet_passes.hpp>
#include <pliant/body/held_passes.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/mesh/sides.hpp>
#include <pliant/topology/hierarchy.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

/// What conditions hold, and pressures press, of a mesh in a backend's memory, whose elements have so many nodes: facets, as sides
/// of its tree, and nodes. Sets of facets are numbered: those of conditions in their order, and those of pressures behind them.
template <int Dim, CellNodes Least, CellNodes Most, Backend B>
class HeldSidesOn {
  using Sides = detail::SidesView<Dim, Least, Most>;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// Finds what is prescribed; whether there is room for so many sets. `tree`: as it is in the backend's memory; row_of(the
  /// user's number): the row of a node, of `rows`.
  template <class RowOf>
  bool set(B const& backend, Hierarchy<Dim> const& tree, Prescribed<Dim> const& prescribed,
           RowOf const& row_of, Index rows) {
    std::map<std::array<Index, 4>, detail::ConditionBits> known;  // by the corners of facets
    std::vector<char> is_corner(tree.points().size(), 0);
    std::vector<DirectionMask> held(at(rows), 0);
    std::vector<std::uint8_t> named(at(rows), 0);
    std::size_t count = 0;
    directions_ = {};
    auto const add = [&](std::vector<Facet<Dim>> const& facets, DirectionMask directions) {
      if (count == detail::most_conditions) return false;
      directions_.of_condition[count] = directions;
      for (auto const& facet : facets) {
        known[mesh::key_of(facet)] |= detail::ConditionBits{1} << count;
        for (std::size_t k = 0; k < facet.corners(); ++k) is_corner[at(facet[k])] = 1;
      }
      ++count;
      return true;
    };
    for (auto const& condition : prescribed.conditions) {
      if (condition.facets.empty()) {
        for (Index const node : condition.nodes) {
          held[at(row_of(node))] |= condition.directions;
          named[at(row_of(node))] = 1;
        }
      } else if (!add(condition.facets, condition.directions)) {
        return false;
      }
    }
    for (auto const& pressure : prescribed.pressures)
      if (!add(pressure.facets, 0)) return false;
    in_turn_ = directions_.in_turn(Dim);
    held_ = upload(backend, held);
    named_ = upload(backend, named);
    rows_ = rows;
    auto const bits_of = [&](auto const& corners) {
      Facet<Dim> facet;
      for (Index const node : corners) {
        if (node < 0) continue;
        if (is_corner[at(node)] == 0) return detail::ConditionBits{0};
        facet.push_back(node);
      }
      auto const own = known.find(mesh::key_of(facet));
      return own == known.end() ? detail::ConditionBits{0} : own->second;
    };
    Sides const sides{tree.tree().lists().view()};
    auto const& lists = tree.tree().lists();
    std::vector<detail::ConditionBits> bits(Dim == 2 ? lists.edges.size() : lists.sides.size(), 0);
    count_ = static_cast<Index>(bits.size());
    if (!known.empty())
      detail::for_each_on_host(count_, 16384, [&](Index side) {
        if constexpr (Dim == 2)
          bits[at(side)] = bits_of(lists.edges[at(side)].nodes);
        else
          bits[at(side)] = bits_of(sides.tree.corners_of(lists.sides[at(side)]));
      });
    // Sides know of their parts, which come behind them.
    for (Index side = known.empty() || lists.divided.empty() ? -1 : count_ - 1; side >= 0; --side) {
      Index const first = sides.first_part(side);
      if (first < 0) continue;
      bool same = true;
      for (Index k = 1; k < sides.parts_of(side); ++k)
        same = same && bits[at(first + k)] == bits[at(first)];
      bits[at(side)] = same ? bits[at(first)] : detail::differs;
    }
    bits_ = upload(backend, bits);
    return true;
  }

  /// Holds the parts of facets that a refinement divided, and their nodes. `held`: directions by row, of `rows`.
  void refine(B const& backend, TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined,
              Index const* of_node, Index rows, DirectionMask* held) {
    Index const first_new = std::exchange(count_, count_in(tree.sizes()));
    detail::grow_keeping(backend, bits_, at(first_new), at(count_));
    extend(backend, rows);
    Sides const sides{tree.view()};
    auto const hold = [&](std::size_t k) {
      bool const is_there = k < in_turn_.size();
      return detail::LoopStep{
          is_there ? refined.leaves : 0,
          detail::HoldParts<Sides>{sides, refined.cells, bits_.data(), directions_,
                                   is_there ? in_turn_[k] : DirectionMask{0}, of_node, held}};
    };
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      detail::in_turn(
          backend,
          detail::LoopStep{count_ - first_new, detail::ClearBits{bits_.data() + first_new}},
          detail::LoopStep{refined.leaves,
                           detail::InheritConditions<Sides>{sides, refined.cells, bits_.data()}},
          hold(K)...);
    }(std::make_index_sequence<Dim>());
  }

  /// Makes room for rows of new nodes, which no condition names.
  void extend(B const& backend, Index rows) {
    detail::grow_keeping(backend, held_, at(rows_), at(rows));
    detail::grow_keeping(backend, named_, at(rows_), at(rows));
    rows_ = rows;
  }
  /// Follows a coarsening, and whether it may be: not where a node would go that a condition names, or a side be whole again of
  /// which conditions hold a part only. Then nothing has changed. `tree`: after it; `of_node`: before it.
  bool coarsen(B const& backend, TreeOn<B> const& tree, Coarsened const& done,
               Index const* of_node) {
    if (found_.size() == 0) found_ = ReadBack<B, Index>(backend, 1);
    found_.set_all(0);
    Index const first = Dim == 2 ? done.staying.edges : done.staying.sides,
                now = count_in(done.now);
    detail::grow(backend, moved_, at(now - first));
    using detail::LoopStep;
    detail::in_turn(
        backend,
        LoopStep{count_ - first,
                 detail::MoveBits{
                     {first, Dim == 2 ? done.edges : done.sides}, bits_.data(), moved_.data()}},
        LoopStep{done.merged, detail::FindCutSides<Sides>{Sides{tree.view()},
                                                          {done.staying.cells, done.cells},
                                                          done.parents,
                                                          bits_.data(),
                                                          moved_.data(),
                                                          first,
                                                          found_.data()}},
        LoopStep{done.before.nodes - done.staying.nodes,
                 detail::FindNamedNodes{done.nodes, of_node + done.staying.nodes, named_.data(),
                                        found_.data()}});
    backend.synchronize();
    if (found_.template first<1>()[0] != 0) return false;
    detail::copy_values<B, detail::ConditionBits>(backend, moved_.data(), bits_.data() + first,
                                                  at(now - first));
    count_ = now;
    return true;
  }
  /// All that is held, by row.
  void hold(B const& backend, TreeOn<B> const& tree, Index const* of_node, Index rows,
            DirectionMask* held) const {
    detail::copy_values<B, DirectionMask>(backend, held_.data(), held, at(rows));
    Sides const sides{tree.view()};
    for (auto const directions : in_turn_)
      backend.for_each(count_, detail::HoldSides<Sides>{sides, bits_.data(), directions_,
                                                        directions, of_node, held});
  }

  /// The rows of the nodes at the facets of a set.
  Array<Index> nodes_of_set(B const& backend, TreeOn<B> const& tree, Index const* of_node,
                            std::size_t set) const {
    auto marks = zeros<std::uint8_t>(backend, at(rows_));
    backend.for_each(count_, detail::MarkNodesOfSet<Sides>{Sides{tree.view()}, bits_.data(),
                                                           bit(set), of_node, marks.data()});
    return selected(backend, rows_, detail::IsMarked<std::uint8_t>{marks.data()});
  }
  /// The facets of a set with so many corners as elements of one type, on these leaves, have them: (facets, Width), the first of which are rows
  /// of nodes, seen from outside.
  template <Element E, int Corners, int Width>
  Array<Index> facets_of_set(B const& backend, TreeOn<B> const& tree, LeavesView const& leaves,
                             Index const* of_node, std::size_t set) const {
    constexpr auto sides = static_cast<Index>(E::cell::sides().size());
    detail::SidesInSet<Sides> const in_set{Sides{tree.view()}, bits_.data(), bit(set)};
    auto cells =
        selected(backend, leaves.count, detail::HasSideInSet<Sides>{in_set, leaves.leaves});
    backend.for_each(static_cast<Index>(cells.size()), detail::LookUp{leaves.leaves, cells.data()});
    detail::SidesOfCells<Sides, sides, Corners> const of_cells{in_set, cells.data()};
    auto const places = selected(backend, static_cast<Index>(cells.size()) * sides, of_cells);
    auto rows = zeros<Index>(backend, places.size() * Width);
    backend.for_each(static_cast<Index>(places.size()),
                     detail::PutFacet<nodes_on_cell<E>, Sides, sides, Corners, Width>{
                         of_cells, places.data(), of_node, rows.data()});
    return rows;
  }

 private:
  static detail::ConditionBits bit(std::size_t set) { return detail::ConditionBits{1} << set; }
  /// The i below n for which wanted(i).
  template <class Wanted>
  static Array<Index> selected(B const& backend, Index n, Wanted const& wanted) {
    auto list = unset<Index>(backend, at(n));
    auto count = zeros<Index>(backend, 1);
    backend.select(n, wanted, list.data(), count.data());
    return detail::extended(backend, list, at(download<Index>(count)[0]));
  }
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index count_in(TreeSizes const& sizes) { return Dim == 2 ? sizes.edges : sizes.sides; }
  detail::DirectionsOf directions_;
  std::vector<DirectionMask> in_turn_;  // see DirectionsOf
  Array<detail::ConditionBits> bits_;   // by side
  Array<detail::ConditionBits> moved_;  // of a coarsening: by side behind the initial mesh's
  Array<DirectionMask> held_;           // by row: by conditions on nodes
  Array<std::uint8_t> named_;           // by row: whether these name the node
  ReadBack<B, Index> found_;            // of a coarsening: whether it may not be
  Index count_ = 0, rows_ = 0;
};

}  // namespace pliant

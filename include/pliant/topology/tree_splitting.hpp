#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/field.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/shorter_diagonal.hpp>
#include <pliant/topology/stamps.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant {

/// Where the nodes of a tree are at rest, in a backend's memory.
template <int Dim>
struct NodesAtRest {
  NodeField<double const, Dim> points;  ///< m, by row
  Index const* of_node;                 ///< rows, by the user's number
};

/// Leaves to split, in a backend's memory: quadrilaterals into four triangles, and into two along the shorter diagonal; hexahedra,
/// and pairs of pyramids, may be on either list. Cells may be marked several times, for two triangles if for both.
struct MarkedToSplit {
  Index const* cells = nullptr;
  Index count = 0;
  Index const* in_two = nullptr;
  Index count_in_two = 0;
};

namespace detail {

struct StampMarked {
  Index const* marked;
  Index* stamps;
  Index now;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (marked[k] >= 0) atomic_store(stamps[marked[k]], now);
  }
};
/// Lists marked leaves that can be split, with their numbers for keys; negative ones are none.
struct ListSplittable {
  TreeView tree;
  Index const* marked;
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = marked[k];
    if (c < 0 || !can_be_split(c)) return;
    if (kind(c) == CellKind::pyramid) {
      Index const other = tree.across_base(c);
      if (other < 0 || kind(other) != CellKind::pyramid || !can_be_split(other)) return;
      list(other);
    }
    list(c);
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE TreeCell const& cell(Index c) const {
    return tree.cells[static_cast<std::size_t>(c)];
  }
  [[nodiscard]] PLIANT_HOST_DEVICE CellKind kind(Index c) const { return cell(c).kind; }
  [[nodiscard]] PLIANT_HOST_DEVICE bool can_be_split(Index c) const {
    bool const has_parts = kind(c) == CellKind::quadrilateral || kind(c) == CellKind::hexahedron ||
                           kind(c) == CellKind::pyramid;
    return has_parts && tree.is_leaf(c) && cell(c).has == CellNodes::corners;
  }
};
struct KeysOfCells {
  Index const* cells;
  std::uint64_t* keys;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    keys[k] = static_cast<std::uint64_t>(cells[k]);
  }
};
/// How each of listed cells is split.
template <int Dim>
struct ChooseDivisions {
  TreeView tree;
  NodesAtRest<Dim> nodes;
  Index const* list;
  Index const* in_two;  // stamps, by cell
  Index now;
  CellSplit* leaves;

  PLIANT_HOST_DEVICE void operator()(Index k) const { leaves[k] = {list[k], division_of(list[k])}; }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE Division division_of(Index c) const {
    auto const* const corners = tree.row(c).nodes;
    if constexpr (Dim == 2) {
      if (in_two[c] != now) return Division::four_triangles;
      return diagonal_of(corners) == 0 ? Division::diagonal_0 : Division::diagonal_1;
    } else {
      if (tree.cells[static_cast<std::size_t>(c)].kind == CellKind::hexahedron)
        return Division::six_pyramids;
      auto const base = tree.corners_of(tree.sides[static_cast<std::size_t>(tree.row(c).sides[0])]);
      Index const first = base[static_cast<std::size_t>(diagonal_of(base.data()))];
      return corners[0] == first || corners[2] == first ? Division::diagonal_0
                                                        : Division::diagonal_1;
    }
  }
  [[nodiscard]] PLIANT_HOST_DEVICE int diagonal_of(Index const* corners) const {
    return shorter_diagonal<Dim>(
        [&](int corner, int d) { return nodes.points(nodes.of_node[corners[corner]], d); });
  }
};

/// Finds the leaves of a tree in a backend's memory that marks split, and how. Has what passes take between them.
template <Backend B>
class TreeSplitting {
 public:
  /// Lists them, in no order; returns how many. Waits. stamps: by cell.
  Index operator()(B const& backend, TreeView const& tree, Index cells, Stamps<B>& stamps,
                   MarkedToSplit const& marked) {
    if (told_.size() == 0) told_ = ReadBack<B, Index>(backend, 1);
    auto const most = std::min(static_cast<std::size_t>(cells),
                               2 * (static_cast<std::size_t>(marked.count) +
                                    static_cast<std::size_t>(marked.count_in_two)));
    stamps.begin(backend, static_cast<std::size_t>(cells));
    in_two_.begin(backend, static_cast<std::size_t>(cells));
    grow(backend, list_, most);
    grow(backend, keys_, most);
    auto counter = zeros<Index>(backend, 1);
    ListOnce const once{stamps.data(), stamps.now(), list_.data(), counter.data()};
    in_turn(
        backend,
        LoopStep{marked.count_in_two, StampMarked{marked.in_two, in_two_.data(), in_two_.now()}},
        LoopStep{marked.count_in_two, ListSplittable{tree, marked.in_two, once}},
        LoopStep{marked.count, ListSplittable{tree, marked.cells, once}},
        LoopStep{1, CopyValue<Index>{counter.data(), told_.data()}});
    backend.synchronize();
    return told_.template first<1>()[0];
  }
  /// Puts the n that were listed in ascending order, with how each is split.
  template <int Dim>
  void choose(B const& backend, TreeView const& tree, Index cells, Index n,
              NodesAtRest<Dim> const& nodes, CellSplit* leaves) {
    in_turn(backend, LoopStep{n, KeysOfCells{list_.data(), keys_.data()}},
            SortStep{n, keys_.data(), list_.data(), key_bits(cells)},
            LoopStep{n, ChooseDivisions<Dim>{tree, nodes, list_.data(), in_two_.data(),
                                             in_two_.now(), leaves}});
  }

 private:
  template <class U>
  using Array = typename B::template Array<U>;

  Array<Index> list_;
  Array<std::uint64_t> keys_;
  Stamps<B> in_two_;  // by cell
  ReadBack<B, Index> told_;
};

}  // namespace detail

}  // namespace pliant

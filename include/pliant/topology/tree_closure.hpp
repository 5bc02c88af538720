#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/topology/cells_at_edges.hpp>
#include <pliant/topology/stamps.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant::detail {

/// Finds the leaves of a tree in a backend's memory that a refinement divides: marked ones and, before each, the leaves that
/// are coarser across one of its edges or sides, and so on.
template <Backend B>
class TreeClosure {
 public:
  TreeClosure(B const& backend, CellsAtEdges const& at_edges)
      : first_at_edge_(upload(backend, at_edges.first())),
        cells_at_edge_(upload(backend, at_edges.cells())),
        counts_(backend, 2) {}

  /// Lists them, in no order; returns how many. `cells`, `initial`: those of the tree and of the initial mesh; stamps: by cell;
  /// `marked`: see TreeOn::refine.
  Index operator()(B const& backend, TreeView const& tree, Index cells, TreeSizes const& initial,
                   Stamps<B>& stamps, Index const* marked, Index count, int max_level) {
    stamps.begin(backend, static_cast<std::size_t>(cells));
    grow(backend, list_, static_cast<std::size_t>(cells));
    grow(backend, counters_, 2);
    Index *const all = counters_.data(), *const listed = all + 1;
    ListOnce const once{stamps.data(), stamps.now(), list_.data(), all};
    LoopStep clear{2, FillValue<Index>{all, 0}};
    LoopStep list_marked{count, ListMarked{tree, marked, max_level, once}};
    LoopStep const tell{2, CopyValue<Index>{all, counts_.data()}};
    if (cells == initial.cells) {  // none has coarser neighbours
      in_turn(backend, clear, list_marked, tell);
      return told(backend)[0];
    }
    CellsAtEdgesView const at_edges{tree, initial.edges, first_at_edge_.data(),
                                    cells_at_edge_.data()};
    Index const each = tree.layout.most_edges();
    Index n = 0, from = 0;
    for (Index most = count; most > 0; most = n - from) {
      most = std::min(most, std::numeric_limits<Index>::max() / each);
      in_turn(backend, clear, list_marked, LoopStep{1, CopyValue<Index>{all, listed}},
              LoopStep{most * each, ListCoarser{at_edges, each, from, listed, once}}, tell);
      auto const counts = told(backend);
      n = counts[0];
      from = std::min(counts[1], from + most);
      clear.n = list_marked.n = 0;
    }
    return n;
  }
  /// Lists marked leaves, and rings of neighbours of these, in no order; returns how many. See TreeOn::with_neighbours.
  Index neighbours(B const& backend, TreeView const& tree, Index cells, TreeSizes const& initial,
                   Stamps<B>& stamps, Index const* marked, Index count, int rings) {
    stamps.begin(backend, static_cast<std::size_t>(cells));
    grow(backend, list_, static_cast<std::size_t>(cells));
    grow(backend, counters_, 2);
    Index* const all = counters_.data();
    ListOnce const once{stamps.data(), stamps.now(), list_.data(), all};
    in_turn(backend, LoopStep{2, FillValue<Index>{all, 0}},
            LoopStep{count, ListMarked{tree, marked, most_levels + 1, once}},
            LoopStep{2, CopyValue<Index>{all, counts_.data()}});
    CellsAtEdgesView const at_edges{tree, initial.edges, first_at_edge_.data(),
                                    cells_at_edge_.data()};
    Index const each = tree.layout.most_edges();
    Index from = 0, n = told(backend)[0];
    for (int ring = 0; ring < rings && from < n; ++ring) {
      for (Index end = n, most = 0; from < end; from += most) {
        most = std::min(end - from, std::numeric_limits<Index>::max() / each);
        in_turn(backend,
                LoopStep{most * each, ListNeighbours{at_edges, each, list_.data() + from, once}},
                LoopStep{2, CopyValue<Index>{all, counts_.data()}});
      }
      n = told(backend)[0];
    }
    return n;
  }
  /// What was listed.
  [[nodiscard]] Index* list() { return list_.data(); }

 private:
  template <class U>
  using Array = typename B::template Array<U>;

  std::array<Index, 2> told(B const& backend) const {
    backend.synchronize();
    return counts_.template first<2>();
  }

  Array<Index> first_at_edge_, cells_at_edge_;  // see CellsAtEdges
  Array<Index> list_, counters_;
  ReadBack<B, Index> counts_;
};

}  // namespace pliant::detail

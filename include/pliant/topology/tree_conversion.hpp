#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/stamps.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant::detail {

/// Lists marked leaves that get other nodes, with their numbers for keys; negative ones are none.
struct ListConvertible {
  TreeView tree;
  Index const* marked;
  NodesOfKinds to;
  Index* stamps;
  Index now;
  Index* list;
  std::uint64_t* keys;
  Index* count;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = marked[k];
    if (c < 0) return;
    auto const& cell = tree.cells[static_cast<std::size_t>(c)];
    if (cell.first_child >= 0 || !to.converts(cell) || !stamps_first(stamps[c], now)) return;
    Index const place = atomic_add(*count, 1);
    list[place] = c;
    keys[place] = static_cast<std::uint64_t>(c);
  }
};
/// Marks the pages of these, and of their edges and sides.
struct MarkConverted {
  Index const* cells;
  PageMarks marks;
  PLIANT_HOST_DEVICE void operator()(Index k) const { marks.whole(cells[k]); }
};
/// Gives each its other nodes, of which those between corners have still to be made.
struct ConvertCells {
  TreeView tree;
  Index const* cells;
  NodesOfKinds to;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto& cell = tree.cells[static_cast<std::size_t>(cells[k])];
    tree.count_leaf(cells[k], -1);
    cell.has = to.of_kind(cell.kind);
    tree.count_leaf(cells[k], 1);
  }
};

/// Gives leaves of a tree in a backend's memory another degree. Has what passes take between them.
template <Backend B>
class TreeConversion {
 public:
  /// Lists the leaves among marked ones that get other nodes, ascending, and gives them these; returns how many. Waits. stamps: by
  /// cell.
  Index convert(B const& backend, PagedTree<B>& tree, Index cells, Stamps<B>& stamps,
                NodesOfKinds const& to, Index const* marked, Index count) {
    if (told_.size() == 0) told_ = ReadBack<B, Index>(backend, 1);
    auto const most = static_cast<std::size_t>(std::min(count, cells));
    stamps.begin(backend, static_cast<std::size_t>(cells));
    grow(backend, list_, most);
    grow(backend, keys_, most);
    auto counter = zeros<Index>(backend, 1);
    in_turn(backend,
            LoopStep{count, ListConvertible{tree.view(), marked, to, stamps.data(), stamps.now(),
                                            list_.data(), keys_.data(), counter.data()}},
            LoopStep{1, CopyValue<Index>{counter.data(), told_.data()}});
    backend.synchronize();
    Index const n = told_.template first<1>()[0];
    if (n == 0) return 0;
    tree.own(backend, [&](PageMarks const& marks, auto const& tell) {
      in_turn(backend, SortStep{n, keys_.data(), list_.data(), key_bits(cells)},
              LoopStep{n, MarkConverted{list_.data(), marks}}, tell);
    });
    backend.for_each(n, ConvertCells{tree.view(), list_.data(), to});
    return n;
  }
  /// Those that it listed.
  [[nodiscard]] Index const* cells() const { return list_.data(); }

 private:
  template <class U>
  using Array = typename B::template Array<U>;

  Array<Index> list_;
  Array<std::uint64_t> keys_;
  ReadBack<B, Index> told_;
};

}  // namespace pliant::detail

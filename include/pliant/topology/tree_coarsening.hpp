#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/coarsening_passes.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/stamps.hpp>

namespace pliant::detail {

/// Merges families of a tree in a backend's memory, as CellMerging and TreeCompaction do on the host. Has what passes take
/// between them.
template <Backend B>
class TreeCoarsening {
 public:
  /// See TreeOn::coarsen. `sizes`: of the tree; `initial`: of the initial mesh; stamps: by cell.
  Coarsened operator()(B const& backend, PagedTree<B>& tree, TreeSizes const& initial,
                       TreeSizes const& sizes, Stamps<B>& stamps, Index const* marked,
                       Index count) {
    Coarsened done{.initial = initial, .before = sizes, .now = sizes};
    find_families(backend, tree.view(), done, stamps, marked, count);
    auto const found = counted(backend);
    Index const merged = found[1], knowing = found[2];
    if (merged == 0) {
      std::swap(counters_, counters_before_);
      return done;
    }
    // Parents are put in order in the launch that marks pages.
    tree.own(backend, [&](PageMarks const& marks) {
      in_turn(backend, SortStep{merged, keys_.data(), parents_.data(), key_bits(done.before.cells)},
              LoopStep{merged * MarkMerged::each, MarkMerged{parents_.data(), marks}},
              LoopStep{knowing, MarkKnowing{knowing_.data(), marks}});
    });
    grow(backend, first_children_, at(merged));
    in_turn(
        backend,
        LoopStep{merged * LeaveChildrenOut::each, LeaveChildrenOut{tree.view(), parents_.data()}},
        LoopStep{merged, MergeCells{tree.view(), parents_.data(), first_children_.data()}});
    auto const view = number(backend, tree, done, knowing);
    move_up(backend, tree, done, view, knowing);
    done.merged = merged;
    done.parents = parents_.data();
    done.first_children = first_children_.data();
    done.nodes = numbers_[0].data();
    done.cells = numbers_[1].data();
    done.edges = numbers_[2].data();
    done.sides = numbers_[3].data();
    return done;
  }

  /// Follows a refinement, after which the tree looks so, in a step of a list of steps.
  LoopStep<ListRefined> follow(TreeView const& tree, Index initial, CellSplit const* refined,
                               Index leaves) {
    if (!knows_) return {};
    return {leaves, {tree, initial, refined, knowing_.data(), counters_.data() + of_knowing}};
  }
  /// The tree is what it was some changes ago.
  void forget() { knows_ = false; }

 private:
  template <class U>
  using Array = typename B::template Array<U>;
  /// Counters: three of a call's lists; and of cells that know of others, until the next call.
  static constexpr std::size_t of_knowing = 3, counters = 4;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Numbers that loops counted, which this waits for.
  std::array<Index, 4> counted(B const& backend) {
    backend.synchronize();
    return counts_.template first<4>();
  }

  /// Lists the parents of families that are merged, and the cells of the initial mesh that know of what came later. Counts
  /// them behind the families of which any child is marked.
  void find_families(B const& backend, TreeView const& tree, Coarsened const& of, Stamps<B>& stamps,
                     Index const* marked, Index count) {
    Index const most = std::min(count, of.before.cells), initial = of.initial.cells;
    stamps.begin(backend, at(of.before.cells));
    std::swap(counters_, counters_before_);
    counters_ = zeros<Index>(backend, counters);
    auto* const counts = counters_.data();
    if (counts_.size() == 0) counts_ = ReadBack<B, Index>(backend, 4);
    grow(backend, families_, at(most));
    grow(backend, parents_, at(most));
    grow(backend, keys_, at(most));
    grow(backend, knowing_, at(initial));
    if (!knows_) backend.select(initial, IsKnowing{tree}, knowing_.data(), counts + 2);
    in_turn(backend,
            LoopStep{count,
                     ListFamilies{
                         tree, marked, {stamps.data(), stamps.now(), families_.data(), counts}}},
            LoopStep{most, ListMergeable{tree, families_.data(), counts, stamps.data(),
                                         stamps.now(), parents_.data(), counts + 1, keys_.data()}},
            LoopStep{knows_ ? 1 : 0,
                     CopyValue<Index>{knows_ ? counters_before_.data() + of_knowing : nullptr,
                                      counts + 2}},
            LoopStep{3, CopyValue<Index>{counts, counts_.data()}});
  }

  /// Numbers what stays. Notes how many of each that are.
  CompactionView number(B const& backend, PagedTree<B> const& tree, Coarsened& of, Index knowing) {
    auto const &initial = of.initial, &before = of.before;
    std::array<Index, 4> const first{initial.nodes, initial.cells, initial.edges, initial.sides},
        counts{before.nodes - first[0], before.cells - first[1], before.edges - first[2],
               before.sides - first[3]};
    used_.begin(backend, at(counts[0]));
    grow(backend, before_, at(*std::ranges::max_element(counts)) + 1);
    for (std::size_t k = 0; k < 4; ++k) grow(backend, numbers_[k], at(counts[k]));
    auto const numbers = [&](std::size_t k) { return NewNumbers{first[k], numbers_[k].data()}; };
    CompactionView const view{tree.view(), initial, numbers(0), numbers(1), numbers(2), numbers(3)};
    UseNodes const use{view, used_.data(), used_.now()};
    auto const sum = [&](std::size_t k, auto const& stays) {
      return ScanStep{counts[k], stays, before_.data()};
    };
    auto const number_staying = [&](std::size_t k) {
      return LoopStep{counts[k] + 1, NumberStaying{before_.data(), counts[k], first[k],
                                                   numbers_[k].data(), counts_.data() + k}};
    };
    in_turn(backend, LoopStep{counts[1], use},
            LoopStep{knowing, UseNodes{view, use.stamps, use.now, knowing_.data()}},
            sum(0, CountStamped{use.stamps, use.now}), number_staying(0), sum(1, CountCells{view}),
            number_staying(1), sum(2, CountUsed<TreeEdge>{view.tree.edges, first[2]}),
            number_staying(2), sum(3, CountUsed<TreeSide>{view.tree.sides, first[3]}),
            number_staying(3));
    auto const staying = counted(backend);
    of.now = {.cells = first[1] + staying[1],
              .edges = first[2] + staying[2],
              .sides = first[3] + staying[3],
              .nodes = first[0] + staying[0]};
    return view;
  }

  /// Moves what stays to its new numbers. Sides look at cells, which are still where they were.
  void move_up(B const& backend, PagedTree<B>& tree, Coarsened const& of,
               CompactionView const& view, Index knowing) {
    auto const &first = of.initial, &before = of.before, &now = of.now;
    auto const move = [&](auto& list, NewNumbers const& numbers, Index count_before, Index count) {
      auto const old = list.replace_from(backend, at(numbers.first), at(count - numbers.first));
      using V = std::remove_cvref_t<decltype(old[0])>;
      return LoopStep{count_before - numbers.first, MoveUp<V>{view, numbers, old, list.pages()}};
    };
    side_stamps_.begin(backend, at(first.sides));
    edge_stamps_.begin(backend, at(first.edges));
    auto const move_sides = move(tree.sides, view.sides, before.sides, now.sides);
    auto const move_edges = move(tree.edges, view.edges, before.edges, now.edges);
    // Few cells leave threads to share them.
    bool const are_few = knowing <= TreeView::few;
    Index const sides = are_few ? TellSides::most : 1, edges = are_few ? TellEdges::most : 1;
    in_turn(backend, move_sides,
            LoopStep{knowing * sides, TellSides{view, tree.view(), knowing_.data(), sides,
                                                side_stamps_.data(), side_stamps_.now()}},
            move_edges,
            LoopStep{knowing * edges, TellEdges{view, tree.view(), knowing_.data(), edges,
                                                edge_stamps_.data(), edge_stamps_.now()}});
    auto const move_cells = move(tree.cells, view.cells, before.cells, now.cells);
    auto const entries = [&](Index cells) { return tree.layout.entry(at(cells)); };
    auto const old_rows =
        tree.rows.replace_from(backend, entries(first.cells), entries(now.cells - first.cells));
    grow(backend, still_knowing_, at(first.cells));
    in_turn(backend, move_cells,
            LoopStep{static_cast<Index>(entries(before.cells - first.cells)),
                     MoveRowsUp{view, old_rows, tree.rows.pages()}},
            LoopStep{knowing, TellCells{view, tree.view(), knowing_.data(), still_knowing_.data(),
                                        counters_.data() + of_knowing}});
    std::swap(knowing_, still_knowing_);
    knows_ = true;
  }

  Array<Index> families_, parents_, first_children_, before_;
  Array<Index> counters_, counters_before_;
  ReadBack<B, Index> counts_;
  // Cells of the initial mesh that know of what came later, each once, from one call to the next: (initial cells).
  Array<Index> knowing_, still_knowing_;
  bool knows_ = false;
  Array<std::uint64_t> keys_;
  Stamps<B> used_;                       // by nodes behind the initial mesh's
  Stamps<B> edge_stamps_, side_stamps_;  // of the initial mesh
  std::array<Array<Index>, 4> numbers_;  // of nodes, cells, edges, sides
};

}  // namespace pliant::detail

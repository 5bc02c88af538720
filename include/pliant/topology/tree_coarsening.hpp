#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/topology/coarsening_passes.hpp>
#include <pliant/topology/compaction_passes.hpp>
#include <pliant/topology/division_marks.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/stamps.hpp>

namespace pliant::detail {

/// Whether all elements of a tree have corners only, all have nodes between these, or some have other nodes than others, or than in the
/// initial mesh.
enum class Degrees { one, two, several };

/// Merges families of a tree in a backend's memory, as CellMerging and TreeCompaction do on the host. Has what passes take
/// between them.
template <Backend B>
class TreeCoarsening {
 public:
  /// See TreeOn::coarsen, or with `of_split` TreeOn::merge. `sizes`: of the tree; `initial`: of the initial mesh; stamps: by cell.
  Coarsened operator()(B const& backend, PagedTree<B>& tree, TreeSizes const& initial,
                       TreeSizes const& sizes, Degrees has, Index few, Stamps<B>& stamps,
                       Index const* marked, Index count, bool of_split = false) {
    Coarsened done{.staying = initial, .before = sizes, .now = sizes};
    bool const finds_first =
        has == Degrees::one && !divisions_.empty() &&
        std::int64_t{sizes.cells} - initial.cells - 8 * std::int64_t{count} > few;
    find_families(backend, tree.view(), done, stamps, marked, count, of_split);
    if (!finds_first) list_knowing(backend, tree.view(), done, nullptr, 0, has == Degrees::several);
    auto const found = counted(backend);
    Index const merged = found[1];
    if (merged == 0) return done;
    // Parents are put in order in the launch that marks pages.
    tree.own(backend, [&](PageMarks const& marks, auto const& tell) {
      Index const knowing = finds_first ? 0 : found[2];
      in_turn(backend, SortStep{merged, keys_.data(), parents_.data(), key_bits(done.before.cells)},
              LoopStep{merged * MarkMerged::each, MarkMerged{parents_.data(), marks}},
              LoopStep{knowing, MarkKnowing{listed(done, knowing), nullptr, marks}}, tell);
    });
    grow(backend, first_children_, at(merged));
    grow(backend, children_, at(merged));
    in_turn(
        backend,
        LoopStep{merged * LeaveChildrenOut::each, LeaveChildrenOut{tree.view(), parents_.data()}},
        LoopStep{merged, MergeCells{tree.view(), parents_.data(), first_children_.data(),
                                    children_.data()}});
    KnowingCells knowing = listed(done, found[2]);
    Index newer = 0;  // cells that may know of others beside these
    if (finds_first) {
      done.staying = divisions_.last_before(first_gone(backend, merged), initial);
      knowing = own_knowing(backend, tree, done, merged);
      newer = sizes.cells - done.staying.cells;
    }
    auto const view = number(backend, tree, done, knowing.count);
    move_up(backend, tree, done, view, knowing, knowing.count + newer);
    divisions_.forget_behind(done.staying);
    done.merged = merged;
    done.parents = parents_.data();
    done.first_children = first_children_.data();
    tell_numbers(done);
    return done;
  }

  /// How many children the parents had that the last call merged.
  [[nodiscard]] Index const* children() const { return children_.data(); }

  /// Takes the nodes away that nobody has any more behind cells that have corners only now, ascending. See TreeOn::lower.
  Lowered lower(B const& backend, PagedTree<B>& tree, TreeSizes const& initial,
                TreeSizes const& sizes, Index const* cells, Index count) {
    Lowered done{{.staying = initial, .before = sizes, .now = sizes}, count, cells};
    begin_counting(backend).run(backend);
    list_knowing(backend, tree.view(), done, cells, count, true);
    auto const knowing = listed(done, counted(backend)[2]);
    tree.own(backend, [&](PageMarks const& marks, auto const& tell) {
      in_turn(backend, LoopStep{knowing.count, MarkKnowing{knowing, nullptr, marks}}, tell);
    });
    auto const view = number(backend, tree, done, knowing.count);
    move_up(backend, tree, done, view, knowing, knowing.count);
    tell_numbers(done);
    return done;
  }

  /// Before a division.
  void note_division(TreeSizes const& sizes) { divisions_.add(sizes); }
  /// The tree is what it is for good; or what it was when that was said the last time.
  void keep() { kept_divisions_ = divisions_; }
  void take_back() { divisions_ = kept_divisions_; }

 private:
  template <class U>
  using Array = typename B::template Array<U>;
  /// Of families of which any child is marked, of those that are merged, and of listed cells that know of newer entries.
  static constexpr std::size_t counters = 3;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  void tell_numbers(Coarsened& done) const {
    done.nodes = numbers_[0].data();
    done.cells = numbers_[1].data();
    done.edges = numbers_[2].data();
    done.sides = numbers_[3].data();
  }
  /// A step behind which loops count.
  LoopStep<FillValue<Index>> begin_counting(B const& backend) {
    if (counts_.size() == 0) counts_ = ReadBack<B, Index>(backend, 4);
    grow(backend, counters_, counters);
    return {static_cast<Index>(counters), {counters_.data(), 0}};
  }
  /// Numbers that loops counted, which this waits for.
  std::array<Index, 4> counted(B const& backend) {
    backend.synchronize();
    return counts_.template first<4>();
  }
  KnowingCells listed(Coarsened const& of, Index count) const {
    return {knowing_.data(), count, of.staying};
  }

  /// Lists the parents of families that are merged. Counts them behind the families of which any child is marked.
  void find_families(B const& backend, TreeView const& tree, Coarsened const& of, Stamps<B>& stamps,
                     Index const* marked, Index count, bool of_split) {
    Index const most = std::min(count, of.before.cells);
    stamps.begin(backend, at(of.before.cells));
    auto const begin = begin_counting(backend);
    auto* const counts = counters_.data();
    grow(backend, families_, at(most));
    grow(backend, parents_, at(most));
    grow(backend, keys_, at(most));
    in_turn(backend, begin,
            LoopStep{count, ListFamilies{tree,
                                         marked,
                                         of_split,
                                         {stamps.data(), stamps.now(), families_.data(), counts}}},
            LoopStep{most, ListMergeable{tree, families_.data(), counts, stamps.data(),
                                         stamps.now(), parents_.data(), counts + 1, keys_.data()}},
            LoopStep{2, CopyValue<Index>{counts, counts_.data()}});
  }

  /// Lists cells among those that stay that know of newer entries, `count` cells that became leaves, or lost nodes, among them.
  /// Gives how many there are at most.
  Index list_knowing(B const& backend, TreeView const& tree, Coarsened const& of,
                     Index const* cells, Index count, bool are_converted) {
    Index const end = of.staying.cells, newer = of.before.cells - end,
                converted = are_converted ? of.staying.cells : 0;
    Index const most = std::min(end, count + newer / 2 + 1 + converted);
    knowing_stamps_.begin(backend, at(end));
    grow(backend, knowing_, at(most));
    auto* const found = counters_.data() + 2;
    ListOnce const list{knowing_stamps_.data(), knowing_stamps_.now(), knowing_.data(), found};
    in_turn(backend, LoopStep{count, ListMerged{cells, end, list}},
            LoopStep{newer, ListDividedSince{tree, end, list}},
            LoopStep{converted, ListConverted{tree, list}},
            LoopStep{1, CopyValue<Index>{found, counts_.data() + 2}});
    return most;
  }
  /// The first cell that goes; waits. What goes with it, and with those behind it, came with their divisions, or with others
  /// of which no cell is left: these, and all behind them, are forgotten.
  [[nodiscard]] TreeSizes first_gone(B const& backend, Index merged) const {
    constexpr Index any = std::numeric_limits<Index>::max();
    double const first = -backend.maximum(merged, NegatedFirstChild{first_children_.data()});
    return {static_cast<Index>(first), any, any, any};
  }
  /// Makes what knows of newer entries than those that stay the tree's own, and gives what of it is listed; waits.
  KnowingCells own_knowing(B const& backend, PagedTree<B>& tree, Coarsened const& of,
                           Index merged) {
    tree.own(backend, [&](PageMarks const& marks, auto const& tell) {
      Index const most = list_knowing(backend, tree.view(), of, parents_.data(), merged, false);
      in_turn(
          backend, LoopStep{most, MarkKnowing{listed(of, most), counters_.data() + 2, marks}},
          LoopStep{of.before.cells - of.staying.cells, MarkKnowing{listed(of, 0), nullptr, marks}},
          tell);
    });
    return listed(of, counts_.template first<4>()[2]);
  }

  /// Numbers what stays. Notes how many of each that are.
  CompactionView number(B const& backend, PagedTree<B> const& tree, Coarsened& of, Index knowing) {
    auto const &staying = of.staying, &before = of.before;
    std::array<Index, 4> const first{staying.nodes, staying.cells, staying.edges, staying.sides},
        counts{before.nodes - first[0], before.cells - first[1], before.edges - first[2],
               before.sides - first[3]};
    used_.begin(backend, at(counts[0]));
    grow(backend, before_, at(*std::ranges::max_element(counts)) + 1);
    for (std::size_t k = 0; k < 4; ++k) grow(backend, numbers_[k], at(counts[k]));
    auto const numbers = [&](std::size_t k) { return NewNumbers{first[k], numbers_[k].data()}; };
    CompactionView const view{tree.view(), staying, numbers(0), numbers(1), numbers(2), numbers(3)};
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
    auto const stay = counted(backend);
    of.now = {.cells = first[1] + stay[1],
              .edges = first[2] + stay[2],
              .sides = first[3] + stay[3],
              .nodes = first[0] + stay[0]};
    return view;
  }

  /// Moves what stays to its new numbers, and tells cells that know of others, `told` in all. Sides look at cells, which are still
  /// where they were.
  void move_up(B const& backend, PagedTree<B>& tree, Coarsened const& of,
               CompactionView const& view, KnowingCells const& knowing, Index told) {
    auto const &first = of.staying, &before = of.before, &now = of.now;
    auto const entries = [&](Index cells) { return tree.layout.entry(at(cells)); };
    side_stamps_.begin(backend, at(first.sides));
    edge_stamps_.begin(backend, at(first.edges));
    tree.sides.reserve_replace(backend, at(first.sides), at(now.sides - first.sides));
    tree.edges.reserve_replace(backend, at(first.edges), at(now.edges - first.edges));
    tree.cells.reserve_replace(backend, at(first.cells), at(now.cells - first.cells));
    tree.rows.reserve_replace(backend, entries(first.cells), entries(now.cells - first.cells));
    auto const sides =
        tree.sides.replace_from(backend, at(first.sides), at(now.sides - first.sides));
    auto const edges =
        tree.edges.replace_from(backend, at(first.edges), at(now.edges - first.edges));
    auto const cells =
        tree.cells.replace_from(backend, at(first.cells), at(now.cells - first.cells));
    auto const rows =
        tree.rows.replace_from(backend, entries(first.cells), entries(now.cells - first.cells));
    auto const move = [](auto const& old, auto const& list, CompactionView const& by,
                         NewNumbers const& numbers, Index count_before) {
      using V = std::remove_cvref_t<decltype(old.before[0])>;
      return LoopStep{count_before - numbers.first,
                      MoveUp<V>{by, numbers, old.before, list.pages()}};
    };
    // Few cells leave threads to share them.
    bool const are_few = told <= TreeView::few;
    Index const each_side = are_few ? TellSides::most : 1,
                each_edge = are_few ? TellEdges::most : 1;
    in_turn(backend, sides.replace, sides.copy,
            move(sides, tree.sides, view, view.sides, before.sides),
            LoopStep{told * each_side, TellSides{view, tree.view(), knowing, each_side,
                                                 side_stamps_.data(), side_stamps_.now()}},
            edges.replace, edges.copy, move(edges, tree.edges, view, view.edges, before.edges),
            LoopStep{told * each_edge, TellEdges{view, tree.view(), knowing, each_edge,
                                                 edge_stamps_.data(), edge_stamps_.now()}},
            cells.replace, cells.copy, move(cells, tree.cells, view, view.cells, before.cells),
            rows.replace, rows.copy,
            LoopStep{static_cast<Index>(entries(before.cells - first.cells)),
                     MoveRowsUp{view, rows.before, tree.rows.pages()}},
            LoopStep{knowing.count, TellCells{view, tree.view(), knowing.listed}});
  }

  DivisionMarks divisions_, kept_divisions_;
  Array<Index> families_, parents_, first_children_, children_, before_;
  Array<Index> counters_;
  ReadBack<B, Index> counts_;
  Array<Index> knowing_;      // see list_knowing
  Stamps<B> knowing_stamps_;  // by cell
  Array<std::uint64_t> keys_;
  Stamps<B> used_;                       // by nodes behind those that stay
  Stamps<B> edge_stamps_, side_stamps_;  // of those that stay
  std::array<Array<Index>, 4> numbers_;  // of nodes, cells, edges, sides
};

}  // namespace pliant::detail

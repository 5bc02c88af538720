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
    auto const found = find_families(backend, tree.view(), done, stamps, marked, count);
    Index const merged = found[0], knowing = found[1];
    if (merged == 0) return done;
    tree.own(backend, [&](PageMarks const& marks) {
      in_turn(backend, LoopStep{merged * MarkMerged::each, MarkMerged{parents_.data(), marks}},
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

 private:
  template <class U>
  using Array = typename B::template Array<U>;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  std::array<Index, 4> counted() {
    std::array<Index, 4> counts;
    counters_.download(counts);
    return counts;
  }

  /// Lists the parents of families that are merged, ascending, and the cells of the initial mesh that know of what came
  /// later; returns how many of each.
  std::array<Index, 2> find_families(B const& backend, TreeView const& tree, Coarsened const& of,
                                     Stamps<B>& stamps, Index const* marked, Index count) {
    stamps.begin(backend, at(of.before.cells));
    counters_ = zeros<Index>(backend, 4);
    grow(backend, families_, at(std::min(count, of.before.cells)));
    backend.for_each(
        count,
        ListFamilies{
            tree, marked, {stamps.data(), stamps.now(), families_.data(), counters_.data()}});
    Index const families = counted()[0];
    if (families == 0) return {};
    grow(backend, parents_, at(families));
    grow(backend, keys_, at(families));
    grow(backend, knowing_, at(of.initial.cells));
    backend.for_each(families, ListMergeable{tree, families_.data(), stamps.data(), stamps.now(),
                                             parents_.data(), counters_.data() + 1, keys_.data()});
    backend.select(of.initial.cells, IsKnowing{tree}, knowing_.data(), counters_.data() + 2);
    auto const counts = counted();
    backend.sort(counts[1], keys_.data(), parents_.data(), key_bits(of.before.cells));
    return {counts[1], counts[2]};
  }

  /// Numbers what stays. Notes how many of each that are.
  CompactionView number(B const& backend, PagedTree<B> const& tree, Coarsened& of, Index knowing) {
    auto const& initial = of.initial;
    CompactionView view{.tree = tree.view(), .initial = initial};
    auto const nodes = of.before.nodes - initial.nodes, cells = of.before.cells - initial.cells;
    used_.begin(backend, at(nodes));
    backend.for_each(cells, UseNodes{view, used_.data(), used_.now()});
    backend.for_each(knowing, UseNodes{view, used_.data(), used_.now(), knowing_.data()});
    view.nodes =
        number_staying(backend, 0, initial.nodes, nodes, CountStamped{used_.data(), used_.now()});
    view.cells = number_staying(backend, 1, initial.cells, cells, CountCells{view});
    view.edges = number_staying(backend, 2, initial.edges, of.before.edges - initial.edges,
                                CountUsed<TreeEdge>{view.tree.edges, initial.edges});
    view.sides = number_staying(backend, 3, initial.sides, of.before.sides - initial.sides,
                                CountUsed<TreeSide>{view.tree.sides, initial.sides});
    auto const staying = counted();
    of.now = {.cells = initial.cells + staying[1],
              .edges = initial.edges + staying[2],
              .sides = initial.sides + staying[3],
              .nodes = initial.nodes + staying[0]};
    return view;
  }
  /// Of `count` from `first` on, of the k-th sort.
  template <class Stays>
  NewNumbers number_staying(B const& backend, std::size_t k, Index first, Index count,
                            Stays const& stays) {
    grow(backend, before_, at(count) + 1);
    grow(backend, numbers_[k], at(count));
    in_turn(backend, ScanStep{count, stays, before_.data()},
            LoopStep{count, NumberStaying{before_.data(), first, numbers_[k].data()}},
            LoopStep{1, CopyValue<Index>{before_.data() + count, counters_.data() + k}});
    return {first, numbers_[k].data()};
  }

  /// Moves what stays to its new numbers. Sides look at cells, which are still where they were.
  void move_up(B const& backend, PagedTree<B>& tree, Coarsened const& of,
               CompactionView const& view, Index knowing) {
    auto const move = [&](auto& list, NewNumbers const& numbers, Index before, Index now) {
      auto const old = list.replace_from(backend, at(numbers.first), at(now));
      using V = std::remove_cvref_t<decltype(old[0])>;
      backend.for_each(before, MoveUp<V>{view, numbers, old, list.pages()});
    };
    auto const &first = of.initial, &before = of.before, &now = of.now;
    move(tree.sides, view.sides, before.sides - first.sides, now.sides - first.sides);
    side_stamps_.begin(backend, at(first.sides));
    backend.for_each(knowing, TellSides{view, tree.view(), knowing_.data(), side_stamps_.data(),
                                        side_stamps_.now()});
    move(tree.edges, view.edges, before.edges - first.edges, now.edges - first.edges);
    edge_stamps_.begin(backend, at(first.edges));
    backend.for_each(knowing, TellEdges{view, tree.view(), knowing_.data(), edge_stamps_.data(),
                                        edge_stamps_.now()});
    move(tree.cells, view.cells, before.cells - first.cells, now.cells - first.cells);
    backend.for_each(knowing, TellCells{view, tree.view(), knowing_.data()});
  }

  Array<Index> families_, parents_, first_children_, knowing_, counters_, before_;
  Array<std::uint64_t> keys_;
  Stamps<B> used_;                       // by nodes behind the initial mesh's
  Stamps<B> edge_stamps_, side_stamps_;  // of the initial mesh
  std::array<Array<Index>, 4> numbers_;  // of nodes, cells, edges, sides
};

}  // namespace pliant::detail

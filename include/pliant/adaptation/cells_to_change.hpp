#pragma once

#include <array>
#include <cstddef>

#include <pliant/backend/array_copies.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/tree_on.hpp>

// Cells of a tree in a backend's memory that are to change, and which of them have to stay as they are.
namespace pliant::detail {

/// Cells to merge with those of their families, refined or split ones, to give a lower degree, to divide, to give a higher degree, and
/// to split; −1: gone.
template <Backend B>
struct CellsToChange {
  using Cells = typename B::template Array<Index>;
  Cells coarsen, merge, lower, refine, raise, split, split_in_two;

  static Index size(Cells const& list) { return static_cast<Index>(list.size()); }

  /// Gives those that are not merged their numbers behind a coarsening.
  void renumber(B const& backend, Coarsened const& merged) {
    if (merged.merged == 0) return;
    for (auto* list : all())
      backend.for_each(size(*list),
                       RenumberCells{{merged.staying.cells, merged.cells}, list->data()});
  }
  [[nodiscard]] CellsToChange copy(B const& backend) {
    CellsToChange copied;
    auto const from = all(), to = copied.all();
    for (std::size_t l = 0; l < from.size(); ++l)
      *to[l] = extended(backend, *from[l], from[l]->size());
    return copied;
  }

  /// Whether a trial tells more than the changes themselves would, one after the other: where one of them limits another, or could
  /// exceed a limit behind another.
  [[nodiscard]] bool need_trial(RefinementLimits const& limits) const {
    bool const others = size(coarsen) > 0 || size(merge) > 0 || size(lower) > 0;
    if (size(refine) > 0 && others) return true;
    bool const adds = size(raise) > 0 || splits();
    int const adding = (size(refine) > 0) + (size(raise) > 0) + splits();
    bool const has_limits =
        limits.nodes != RefinementLimits{}.nodes || limits.leaves != RefinementLimits{}.leaves;
    return has_limits && adds && (others || adding > 1);
  }
  [[nodiscard]] bool splits() const { return size(split) > 0 || size(split_in_two) > 0; }
  [[nodiscard]] MarkedToSplit to_split() const {
    return {split.data(), size(split), split_in_two.data(), size(split_in_two)};
  }
  /// Tries the changes on a tree, and leaves out what a refinement beside it divides: families that would be divided again, and cells
  /// that keep their degree. Throws Error where a limit would be exceeded. `Reshapes`: whether cells may be split, and merged again.
  template <bool Reshapes, int Dim>
  void leave_what_is_refined(B const& backend, TreeOn<B>& tree, NodesOfKinds const& raised,
                             NodesAtRest<Dim> const& nodes, RefinementLimits const& limits) {
    for (bool again = true; again;) {
      auto trial = copy(backend);
      Coarsened merged;
      if (size(coarsen) > 0) merged = tree.coarsen(coarsen.data(), size(coarsen));
      trial.renumber(backend, merged);
      Divided<B> families(backend, merged.parents, merged.merged, new_cells(merged));
      Merged whole;
      auto parents = unset<Index>(backend, merge.size()),
           partners = unset<Index>(backend, merge.size());
      if constexpr (Reshapes)
        if (size(merge) > 0) {
          backend.for_each(size(merge), FindWholes{tree.view(), trial.merge.data(), parents.data(),
                                                   partners.data()});
          whole = tree.merge(trial.merge.data(), size(merge));
        }
      trial.renumber(backend, whole);
      if (whole.merged > 0) families.renumber(backend, new_cells(whole));
      Divided<B> wholes(backend, whole.parents, whole.merged, new_cells(whole));
      Lowered lowered;
      if (size(lower) > 0) lowered = tree.lower(trial.lower.data(), size(lower));
      Divided<B> cells(backend, lowered.lowered_cells, lowered.lowered,
                       {tree.sizes().cells, nullptr});
      auto const refined = tree.refine(trial.refine.data(), size(refine), limits);
      for (auto* list : {&families, &wholes, &cells}) list->find(backend, refined);
      if (size(raise) > 0) (void)tree.raise(trial.raise.data(), size(raise), raised, limits);
      if constexpr (Reshapes)
        if (splits()) (void)tree.split(trial.to_split(), nodes, limits);
      tree.take_back();
      again = families.any() || wholes.any() || cells.any();
      if (families.any())
        select(backend, coarsen, IsMergedForGood{tree.view(), coarsen.data(), families.listed()});
      if (wholes.any())
        select(backend, merge, IsWholeForGood{parents.data(), partners.data(), wholes.listed()});
      if (cells.any()) select(backend, lower, IsLoweredForGood{trial.lower.data(), cells.listed()});
    }
  }

 private:
  std::array<Cells*, 7> all() {
    return {&coarsen, &merge, &lower, &refine, &raise, &split, &split_in_two};
  }
  static void select(B const& backend, Cells& list, auto const& stays) {
    auto left = zeros<Index>(backend, list.size());
    auto count = zeros<Index>(backend, 1);
    backend.select(size(list), stays, left.data(), count.data());
    auto const n = download<Index>(count)[0];
    backend.for_each(n, LookUp{list.data(), left.data()});
    list = extended(backend, left, static_cast<std::size_t>(n));
  }
};

}  // namespace pliant::detail

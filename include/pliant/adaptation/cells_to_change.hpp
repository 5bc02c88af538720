#pragma once

#include <cstddef>

#include <pliant/backend/array_copies.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/tree_on.hpp>

// Cells of a tree in a backend's memory that are to change, and which of them have to stay as they are.
namespace pliant::detail {

/// Cells to divide, to merge with those of their families, and to give a lower or higher degree; −1: gone.
template <Backend B>
struct CellsToChange {
  using Cells = typename B::template Array<Index>;
  Cells refine, merge, lower, raise;

  static Index size(Cells const& list) { return static_cast<Index>(list.size()); }

  /// Gives those that are not merged their numbers behind a coarsening.
  void renumber(B const& backend, Coarsened const& merged) {
    if (merged.merged == 0) return;
    for (auto* list : {&refine, &lower, &raise})
      backend.for_each(size(*list),
                       RenumberCells{{merged.staying.cells, merged.cells}, list->data()});
  }
  [[nodiscard]] CellsToChange copy(B const& backend) const {
    auto const copied = [&](Cells const& list) { return extended(backend, list, list.size()); };
    return {copied(refine), copied(merge), copied(lower), copied(raise)};
  }

  /// Whether a trial tells more than the changes themselves would, one after the other: where one of them limits another, or could
  /// exceed a limit behind another.
  [[nodiscard]] bool need_trial(RefinementLimits const& limits) const {
    bool const others = size(merge) > 0 || size(lower) > 0;
    return (size(refine) > 0 && others) || (size(raise) > 0 && (others || size(refine) > 0) &&
                                            limits.nodes != RefinementLimits{}.nodes);
  }
  /// Tries the changes on a tree, and leaves out what a refinement beside it divides: families that would be divided again, and cells
  /// that keep their degree. Throws Error where a limit would be exceeded.
  void leave_what_is_refined(B const& backend, TreeOn<B>& tree, NodesOfKinds const& raised,
                             RefinementLimits const& limits) {
    for (bool again = true; again;) {
      auto trial = copy(backend);
      Coarsened merged;
      if (size(merge) > 0) merged = tree.coarsen(merge.data(), size(merge));
      trial.renumber(backend, merged);
      Divided<B> families(backend, merged.parents, merged.merged, new_cells(merged));
      Lowered lowered;
      if (size(lower) > 0) lowered = tree.lower(trial.lower.data(), size(lower));
      Divided<B> cells(backend, lowered.lowered_cells, lowered.lowered,
                       {tree.sizes().cells, nullptr});
      auto const refined = tree.refine(trial.refine.data(), size(refine), limits);
      families.find(backend, refined);
      cells.find(backend, refined);
      if (size(raise) > 0) (void)tree.raise(trial.raise.data(), size(raise), raised, limits);
      tree.take_back();
      again = families.any() || cells.any();
      if (families.any())
        select(backend, merge, IsMergedForGood{tree.view(), merge.data(), families.listed()});
      if (cells.any()) select(backend, lower, IsLoweredForGood{trial.lower.data(), cells.listed()});
    }
  }

 private:
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

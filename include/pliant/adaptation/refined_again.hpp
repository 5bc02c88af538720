#pragma once

#include <cstddef>

#include <pliant/backend/read_back.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant::detail {

/// Gives cells their numbers behind a coarsening; −1 to those that went.
template <Backend B, class Cells>
void renumber(B const& backend, Cells& cells, Coarsened const& merged) {
  backend.for_each(static_cast<Index>(cells.size()),
                   RenumberCells{{merged.staying.cells, merged.cells}, cells.data()});
}

/// Tries a change on a tree, and takes from the elements to merge those of families that a refinement beside them would divide again.
/// Throws Error where a limit would be exceeded.
template <Backend B, class Cells>
void leave_what_is_refined(B const& backend, TreeOn<B>& tree, Cells const& refine, Cells& merge,
                           RefinementLimits const& limits) {
  auto const size = [](auto const& list) { return static_cast<Index>(list.size()); };
  while (merge.size() > 0) {
    auto const merged = tree.coarsen(merge.data(), size(merge));
    if (merged.merged == 0) return;
    auto cells = extended(backend, refine, refine.size());
    renumber(backend, cells, merged);
    auto const refined = tree.refine(cells.data(), size(cells), limits);
    auto const families = static_cast<std::size_t>(merged.merged);
    auto parents = zeros<Index>(backend, families);
    copy_values<B, Index>(backend, merged.parents, parents.data(), families);
    auto again = zeros<Index>(backend, families + 1);  // and whether there are any
    backend.for_each(refined.leaves, FindMergedAgain{refined.cells,
                                                     parents.data(),
                                                     {merged.staying.cells, merged.cells},
                                                     merged.merged,
                                                     again.data()});
    auto any = zeros<Index>(backend, 1);
    copy_values<B, Index>(backend, again.data() + families, any.data(), 1);
    bool const some_are = download<Index>(any)[0] != 0;
    tree.take_back();
    if (!some_are) return;
    auto left = zeros<Index>(backend, merge.size());
    auto count = zeros<Index>(backend, 1);
    backend.select(
        size(merge),
        IsMergedForGood{tree.view(), merge.data(), parents.data(), merged.merged, again.data()},
        left.data(), count.data());
    auto const n = download<Index>(count)[0];
    backend.for_each(n, LookUp{merge.data(), left.data()});
    merge = extended(backend, left, static_cast<std::size_t>(n));
  }
}

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <vector>

#include <pliant/backend/patch_list.hpp>
#include <pliant/openmp/patches.hpp>
#include <pliant/openmp/threads.hpp>

namespace pliant::detail {

/// Accumulates over a list of few patches at the cost of these: accumulate_in(k) does the k-th of them, and the
/// rows of the others are not looked at. What active patches add to a node is folded by the first of them.
template <class Elements, class Accumulate, class T, int C>
void accumulate_few(Threads const& threads, ActiveElements<Elements> const& active,
                    Accumulate const& accumulate_in, NodeField<T, C> out) {
  auto const& elements = active.elements;
  auto const& rows = elements.rows();
  std::vector<unsigned char> acts(static_cast<std::size_t>(elements.patch_count()), 0);
  for (Index k = 0; k < active.patch_count(); ++k)
    acts[static_cast<std::size_t>(active.patch(k))] = 1;
  auto const is_active = [&](Index row) {
    return acts[static_cast<std::size_t>(rows.patch_of_row(row))] != 0;
  };
  auto const add = [&](Index node, Index row) {
    for (int c = 0; c < C; ++c) out(node, c) += out(row, c);
  };
  threads.for_each_block(active.patch_count(), accumulate_in);
  threads.for_each_block(active.patch_count(), [&](Index k) {
    auto const [first, last] = rows.scratch_of(active.patch(k));
    for (Index own = first; own < last; ++own) {
      auto const folded = rows.folded_of_row(own);
      if (folded.rows.size() == 1) {
        add(folded.node, own);
      } else if (*std::ranges::find_if(folded.rows, is_active) == own) {
        for (Index row : folded.rows)
          if (is_active(row)) add(folded.node, row);
      }
    }
  });
}

}  // namespace pliant::detail

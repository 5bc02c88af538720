#pragma once

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Nodes as weighted sums over others, as compressed rows in the memory of a backend: row k, of node[k], has the entries
/// first[k] to before first[k + 1] of `other` and `weight`. Arrays may be longer than that.
template <Backend B>
struct RowsOn {
  Index count = 0;
  typename B::template Array<Index> node, first, other;
  typename B::template Array<typename B::scalar> weight;
};

}  // namespace pliant

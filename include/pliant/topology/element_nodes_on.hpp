#pragma once

#include <array>
#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant::detail {

/// Makes the nodes that elements on cells of a tree have between their corners, where they are missing, in a backend's memory: see
/// ElementNodesView.
template <Backend B>
class ElementNodesOn {
 public:
  /// How many are missing on these cells, which make them as they lie there. Waits.
  Index find(B const& backend, TreeView const& tree, Index const* cells, Index count) {
    return find(backend, {tree, cells, nullptr, false}, count);
  }
  /// The same on the children of n divided leaves, where they lie on these. Waits.
  Index find(B const& backend, DivisionView const& division, Index n) {
    CountQuadratic const quadratic{division};
    grow(backend, before_, static_cast<std::size_t>(n) + 1);
    grow(backend, children_, static_cast<std::size_t>(n) * RefinementPattern::most_children);
    in_turn(backend, ScanStep{n, quadratic, before_.data()},
            LoopStep{n, ListQuadratic{quadratic, before_.data(), children_.data()}});
    Index const count = entry(backend, n);
    return find(backend, {division.tree, children_.data(), nullptr, true}, count);
  }
  /// Makes those that were found, from a number on. Waits for nothing.
  void make(B const& backend, Index first, PlacedNode* made) {
    view_.first_node = first;
    view_.made = made;
    backend.for_each(count_, MakeNodes{view_, before_.data()});
  }

 private:
  template <class U>
  using Array = typename B::template Array<U>;

  Index find(B const& backend, ElementNodesView const& view, Index count) {
    view_ = view;
    count_ = count;
    grow(backend, own_, static_cast<std::size_t>(count));
    grow(backend, before_, static_cast<std::size_t>(count) + 1);
    view_.own = own_.data();
    in_turn(backend, LoopStep{count, ClaimNodes{view_}}, LoopStep{count, FindNodes{view_}},
            ScanStep{count, CountNodes{own_.data()}, before_.data()});
    return entry(backend, count);
  }
  Index entry(B const& backend, Index i) {
    if (told_.size() == 0) told_ = ReadBack<B, Index>(backend, 1);
    backend.for_each(1, CopyValue<Index>{before_.data() + i, told_.data()});
    backend.synchronize();
    return told_.template first<1>()[0];
  }

  ElementNodesView view_{};
  Index count_ = 0;
  Array<Index> children_, before_;
  Array<CellNodesMade> own_;
  ReadBack<B, Index> told_;
};

}  // namespace pliant::detail

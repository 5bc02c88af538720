#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/constraint/condition.hpp>

namespace pliant {

/// What a node has to do with patches that sleep, bit by bit.
using NodeWatch = std::uint8_t;
inline constexpr NodeWatch beside_awake = 1, beside_asleep = 2;

/// Nodes that lists take together, since they are numbered as patches first touch them; a multiple of a warp.
inline constexpr Index nodes_of_run = 64;

namespace detail {
/// f(piece) of patches: the largest of those of their pieces.
template <class F>
struct LargestOfPieces {
  F f;
  Index const* first_other;
  std::uint8_t* marks;
  PLIANT_HOST_DEVICE void operator()(Index p) const {
    std::uint8_t most = f(p);
    for (Index piece = first_other[p]; piece < first_other[p + 1]; ++piece)
      if (auto const other = f(piece); other > most) most = other;
    marks[p] = most;
  }
};
/// Marks the pieces of patches at listed nodes.
struct MarkAtNodes {
  Index const* nodes;
  Index const *first, *pieces;
  std::uint8_t* marks;

  PLIANT_HOST_DEVICE void operator()(Index n) const {
    for (Index k = first[nodes[n]]; k < first[nodes[n] + 1]; ++k) atomic_store(marks[pieces[k]], 1);
  }
};
struct MarkOfPiece {
  std::uint8_t const* marks;
  PLIANT_HOST_DEVICE std::uint8_t operator()(Index piece) const { return marks[piece]; }
};
}  // namespace detail

/// Which nodes belong to which patches. Patches of all element types are numbered through, in the order of the
/// types; the masters of a slave belong to its patches too. A patch falls into pieces that share no node with each other, most
/// into one, where bodies lie in one mesh into more: what moves in one does not reach the others. Numbers are internal.
template <Backend B>
struct PatchNodes {
  template <class U>
  using Array = typename B::template Array<U>;

  std::vector<Index> first_of_type;   // (types + 1): patches
  Array<Index> first, pieces;         // compressed rows of nodes: their pieces, by patches
  Array<Index> first_beside, beside;  // the same of pieces: those that share a node with each
  /// (pieces): each patch's own number, then those of other pieces, of one patch after the other.
  Array<Index> patch;
  Array<Index> first_other;  // (patches + 1): where the other pieces of each begin
  /// (pieces): the marks with which a look begins, at driven nodes, and those of the look.
  Array<std::uint8_t> driven, stirred;
  std::shared_ptr<void const> driven_by;  // the conditions that `driven` is of
  Array<std::uint8_t> turns;              // (patches): which fall asleep or wake at a look
  /// While patches sleep: how many runs have a node beside what is awake, and these.
  Array<Index> awake_runs;

  Index count() const { return first_of_type.back(); }
  Index pieces_count() const { return static_cast<Index>(patch.size()); }
  /// f(piece), a mark, of patches on the host: the largest of those of their pieces.
  template <class F>
  std::vector<std::uint8_t> marks_of_patches(B const& backend, F const& f) const {
    auto marks = unset<std::uint8_t>(backend, static_cast<std::size_t>(count()));
    backend.for_each(count(), detail::LargestOfPieces<F>{f, first_other.data(), marks.data()});
    return download<std::uint8_t>(marks);
  }
};

/// What follows from State::rest while patches sleep. A sleeping patch does not move: its nodes are held where they
/// are, so that the forces of its elements stay what they were.
template <Backend B>
struct AwakeSet {
  template <class U>
  using Array = typename B::template Array<U>;

  std::vector<Array<Index>> patches;  // (types): the lists of those awake, for over()
  Array<std::uint8_t> asleep;         // (patches)
  Array<NodeWatch> nodes;             // (nodes)
  Array<DirectionMask> still;         // (nodes): held by conditions, or asleep
  Array<typename B::scalar> kept;     // (nodes, 4) and scratch rows, N: of sleeping patches
  Index awake = 0;                    // patches
};

namespace detail {

/// f(i), or its number, where something is awake beside a node.
template <class F>
struct AtAwakeNodes {
  NodeWatch const* nodes;
  F f;
  PLIANT_HOST_DEVICE auto operator()(Index i) const {
    using Result = decltype(f(i));
    if (!(nodes[i] & beside_awake)) return Result();
    return f(i);
  }
};

/// The same for places of a list of runs.
template <class F>
struct InAwakeRuns {
  static constexpr bool few_nodes = true;  // told to backends: see OfFewNodes of Cuda
  Index const* runs;
  AtAwakeNodes<F> at;
  Index nodes;
  PLIANT_HOST_DEVICE void operator()(Index place) const {
    Index const k = place / nodes_of_run, run = runs[k + 1];
    if (k >= runs[0]) return;
    Index const i = run * nodes_of_run + place % nodes_of_run;
    if (i < nodes) at(i);
  }
};

}  // namespace detail

}  // namespace pliant

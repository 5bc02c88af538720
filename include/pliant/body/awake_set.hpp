#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/constraint/condition.hpp>

namespace pliant {

/// What a node has to do with patches that sleep, bit by bit.
using NodeWatch = std::uint8_t;
inline constexpr NodeWatch beside_awake = 1, beside_asleep = 2;

/// Nodes that lists take together, since they are numbered as patches first touch them; a multiple of a warp.
inline constexpr Index nodes_of_run = 64;

/// Which nodes belong to which patches. Patches of all element types are numbered through, in the order of the
/// types; the masters of a slave belong to its patches too. A patch falls into pieces that share no node with each other, most
/// into one, where bodies lie in one mesh into more: what moves in one does not reach the others. Numbers are internal.
template <Backend B>
struct PatchNodes {
  template <class U>
  using Array = typename B::template Array<U>;

  std::vector<Index> first_of_type;  // (types + 1): patches
  /// (pieces): each patch's own number, then those of other pieces, of one patch after the other.
  std::vector<Index> patch_of_piece;
  std::vector<Index> first_of_node, pieces_of_node;  // compressed rows
  std::vector<Index> first_neighbour, neighbours;    // the same of patches, that share a node
  std::vector<Index> first_run, runs;  // (patches): the same of the runs in which their nodes are
  Array<Index> first, pieces, patch;   // rows of nodes, and patches, in the backend's memory
  Array<Index> first_beside, beside;   // rows of the pieces that share a node
  Array<Index> first_other;            // (patches + 1): where the other pieces of each begin
  /// (pieces): the marks with which a look begins, at driven nodes, and those of the look.
  Array<std::uint8_t> driven, stirred;
  std::shared_ptr<void const> driven_by;  // the conditions that `driven` is of
  Array<std::uint8_t> turns;              // (patches): which fall asleep or wake at a look
  /// While patches sleep: how many runs have a node beside what is awake, and these.
  Array<Index> awake_runs;

  Index count() const { return first_of_type.back(); }
  Index pieces_count() const { return static_cast<Index>(patch_of_piece.size()); }
  /// The patches that share a node with this one.
  std::span<Index const> beside_of(std::size_t own) const {
    auto const from = static_cast<std::size_t>(first_neighbour[own]),
               to = static_cast<std::size_t>(first_neighbour[own + 1]);
    return std::span(neighbours).subspan(from, to - from);
  }
  /// From marks of pieces to marks of patches: the largest.
  std::vector<std::uint8_t> of_patches(std::vector<std::uint8_t> marks) const {
    auto const patches = static_cast<std::size_t>(count());
    for (std::size_t piece = patches; piece < marks.size(); ++piece) {
      auto& own = marks[static_cast<std::size_t>(patch_of_piece[piece])];
      own = std::max(own, marks[piece]);
    }
    marks.resize(patches);
    return marks;
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

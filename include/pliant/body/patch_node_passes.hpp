#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/config.hpp>

// Passes that find which nodes belong to which patches, for loops of a backend. A visit is a node of an element, or a master
// of one; a member is a node of a patch, whichever elements it is visited from. Members are numbered by their nodes, those of
// a node by their patches.
namespace pliant::detail {

/// The masters of slaves, by rows of nodes.
struct MastersOfNodes {
  Index const* slave_at =
      nullptr;  // by row: which slave is there, and one more; null: none anywhere
  Index const *first = nullptr, *other = nullptr;

  /// visit(node) for a node and its masters.
  template <class Visit>
  PLIANT_HOST_DEVICE void with_masters(Index node, Visit const& visit) const {
    visit(node);
    Index const slave = slave_at == nullptr ? 0 : slave_at[node];
    for (Index k = slave > 0 ? first[slave - 1] : 0; slave > 0 && k < first[slave]; ++k)
      visit(other[k]);
  }
};
/// slave_at of MastersOfNodes.
struct NumberSlavesByRow {
  Index const* node;
  Index* slave_at;
  PLIANT_HOST_DEVICE void operator()(Index k) const { slave_at[node[k]] = k + 1; }
};

/// How many visits an element makes.
struct CountVisits {
  ElementRows rows;
  int nodes;
  MastersOfNodes masters;

  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index e, Visit const& visit_node) const {
    for (int a = 0; a < nodes; ++a) masters.with_masters(rows[e][a], visit_node);
  }
  PLIANT_HOST_DEVICE Index operator()(Index e) const {
    Index count = 0;
    visit(e, [&](Index) { ++count; });
    return count;
  }
};
/// Visits, in the order of patches, those of an element one after the other.
struct VisitArrays {
  std::uint64_t* nodes;
  Index* order;   // the visits, sorted by nodes with them
  Index* patch;   // by the visit
  Index* leader;  // by the visit: the first one of its element
};
/// Lists those of the elements of a type.
struct ListVisits {
  CountVisits of;
  PatchRanges patches;
  Index first_patch, first_visit;  // of the type
  Index const* start;              // by the element
  VisitArrays to;

  PLIANT_HOST_DEVICE void operator()(Index e) const {
    Index const patch = first_patch + patches.patch_of(e), leader = first_visit + start[e];
    Index next = leader;
    of.visit(e, [&](Index node) {
      to.nodes[next] = static_cast<std::uint64_t>(node);
      to.order[next] = next;
      to.patch[next] = patch;
      to.leader[next++] = leader;
    });
  }
};

/// Whether a sorted visit is the first of its member: visits of a node come by their patches, as they are listed.
struct IsFirstOfMember {
  VisitArrays visits;
  PLIANT_HOST_DEVICE Index operator()(Index i) const {
    return i == 0 || visits.nodes[i] != visits.nodes[i - 1] ||
                   visits.patch[visits.order[i]] != visits.patch[visits.order[i - 1]]
               ? 1
               : 0;
  }
};
/// Ends the rows before that of the key at a place of n sorted ones, where it is the first of its row. first: (rows + 1).
struct BoundsOfRows {
  std::uint64_t const* keys;
  int shift;  // a row's number is its key without so many of the lowest bits
  Index n, rows;
  Index* first;

  [[nodiscard]] PLIANT_HOST_DEVICE Index row(Index i) const {
    return static_cast<Index>(keys[i] >> shift);
  }
  PLIANT_HOST_DEVICE void at(Index i, Index number, Index total) const {
    for (Index r = i == 0 ? 0 : row(i - 1) + 1; r <= row(i); ++r) first[r] = number;
    for (Index r = row(i) + 1; i == n - 1 && r <= rows; ++r) first[r] = total;
  }
};
/// Numbers members, and tells visits theirs.
struct PutMembers {
  VisitArrays visits;
  Index const* before;  // by the sorted visit: how many members began before it
  BoundsOfRows bounds;
  Index* member;  // by the visit
  Index* patch;   // by the member

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const visit = visits.order[i], own = before[i + 1] - 1;
    member[visit] = own;
    if (before[i] == own) patch[own] = visits.patch[visit];
    bounds.at(i, before[i], before[bounds.n]);
  }
};

/// Each member is a piece of its own.
struct BeginPieces {
  Index* piece;
  PLIANT_HOST_DEVICE void operator()(Index m) const { piece[m] = m; }
};
/// Members that elements join become one piece: all of a piece have the number of its first one in the end. A pass over
/// visits takes the least of what an element joins; it sets `changed` until there is nothing more to do.
struct JoinMembers {
  Index const *member, *leader;  // by the visit
  Index* piece;                  // by the member
  Index* changed;

  PLIANT_HOST_DEVICE void operator()(Index visit) const {
    Index const a = member[leader[visit]], b = member[visit];
    Index const of_a = atomic_load(piece[a]), of_b = atomic_load(piece[b]);
    if (of_a == of_b) return;
    Index const least = of_a < of_b ? of_a : of_b;
    atomic_min(piece[a], least);
    atomic_min(piece[b], least);
    atomic_min(piece[of_a], least);
    atomic_min(piece[of_b], least);
    atomic_set(*changed, 1);
  }
};
/// Each member takes the number that the one that it has the number of has.
struct FollowPieces {
  Index* piece;
  PLIANT_HOST_DEVICE void operator()(Index m) const {
    atomic_store(piece[m], atomic_load(piece[atomic_load(piece[m])]));
  }
};

/// The first piece of each patch, of which it is the own one.
struct FindOwnPieces {
  Index const *piece, *patch;  // by the member
  Index* own;                  // by the patch: the first member of the piece
  PLIANT_HOST_DEVICE void operator()(Index m) const {
    if (piece[m] == m) atomic_min(own[patch[m]], m);
  }
};
/// Whether a member is the first one of another piece than its patch's own.
struct BeginsOther {
  Index const *piece, *patch, *own;
  PLIANT_HOST_DEVICE Index operator()(Index m) const {
    return piece[m] == m && own[patch[m]] != m ? 1 : 0;
  }
};
/// Lists these, to be sorted by their patches.
struct ListOthers {
  BeginsOther begins;
  Index const* before;
  std::uint64_t* patches;
  Index* members;
  PLIANT_HOST_DEVICE void operator()(Index m) const {
    if (begins(m) == 0) return;
    patches[before[m]] = static_cast<std::uint64_t>(begins.patch[m]);
    members[before[m]] = m;
  }
};
/// Gives pieces their numbers: those of patches, then the others'.
struct NumberOwnPieces {
  Index const* own;
  Index *number, *patch_of_piece;  // number: by the first member
  PLIANT_HOST_DEVICE void operator()(Index p) const {
    patch_of_piece[p] = p;
    number[own[p]] = p;
  }
};
struct NumberOtherPieces {
  std::uint64_t const* patches;
  Index const* members;
  Index first;  // how many patches there are
  Index *number, *patch_of_piece;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    patch_of_piece[first + k] = static_cast<Index>(patches[k]);
    number[members[k]] = first + k;
  }
};
/// Where the other pieces of patches begin.
struct BoundsOfOthers {
  BoundsOfRows bounds;
  Index first;
  PLIANT_HOST_DEVICE void operator()(Index k) const { bounds.at(k, first + k, first + bounds.n); }
};
struct PutPieces {
  Index const *piece, *number;
  Index* to;
  PLIANT_HOST_DEVICE void operator()(Index m) const { to[m] = number[piece[m]]; }
};

/// How many ordered pairs of pieces meet at a node.
struct CountMeetings {
  Index const* first;
  PLIANT_HOST_DEVICE Index operator()(Index node) const {
    Index const count = first[node + 1] - first[node];
    return count * (count - 1);
  }
};
/// Lists them as keys.
struct ListMeetings {
  Index const *first, *pieces;  // rows of nodes
  Index const* start;
  int bits;  // of a piece's number
  std::uint64_t* keys;
  Index* order;

  PLIANT_HOST_DEVICE void operator()(Index node) const {
    Index next = start[node];
    for (Index k = first[node]; k < first[node + 1]; ++k)
      for (Index other = first[node]; other < first[node + 1]; ++other) {
        if (other == k) continue;
        keys[next] = static_cast<std::uint64_t>(pieces[k]) << bits |
                     static_cast<std::uint64_t>(pieces[other]);
        order[next] = next;
        ++next;
      }
  }
};
/// Of sorted keys, each once, the second piece, in rows of the first.
struct PutBeside {
  std::uint64_t const* keys;
  int bits;
  Index const* before;  // by the key: how many differ before it
  BoundsOfRows bounds;
  Index* beside;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (before[i] != before[i + 1])
      beside[before[i]] = static_cast<Index>(keys[i] & ((std::uint64_t{1} << bits) - 1));
    bounds.at(i, before[i], before[bounds.n]);
  }
};

}  // namespace pliant::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/body/leaf_order_passes.hpp>
#include <pliant/element/element.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/topology/rows_of_element.hpp>
#include <pliant/topology/tree_on.hpp>

// The elements of a type after a refinement or a coarsening, in a backend's memory: what belongs to each is taken from where it was
// before, or comes from the tree.
namespace pliant {

namespace detail {

/// Puts the rows of nodes of elements, `Width` entries of which the first are the nodes; the others are zero.
template <Element E, int Width>
struct PutElementRows {
  TreeView tree;
  LeavesView leaves;
  ElementRows before;    // null: all come from the tree
  Index const* of_node;  // rows of fields
  Index* to;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = leaves.leaves[i];
    Index* const row = to + static_cast<std::ptrdiff_t>(Width) * i;
    if (before.nodes != nullptr && !leaves.is_new(i)) {
      Index const* const own = before[leaves.from(i)];
      for (int a = 0; a < Width; ++a) row[a] = own[a];
    } else {
      auto const own = rows_of_element<E>(tree, cell, of_node);
      for (std::size_t a = 0; a < std::size_t{Width}; ++a) row[a] = a < own.size() ? own[a] : 0;
    }
  }
};

/// Whether the leaf at a place was not there before.
struct IsNewLeaf {
  LeavesView leaves;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return leaves.is_new(i); }
};
/// Whether the leaf that was at a place is merged into another.
struct IsMergedLeaf {
  LeavesView leaves;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return leaves.before[i] < 0; }
};
/// Whether an element at a place is another one, as a condition says, or has a node that a change displaced.
template <int Nodes, class IsOther>
struct IsOtherOrDisplaced {
  IsOther is_other;
  ElementRows rows;
  std::uint8_t const* displaced;  // by the row of a node
  PLIANT_HOST_DEVICE bool operator()(Index i) const {
    bool is = is_other(i);
    for (int a = 0; a < Nodes; ++a) is = is || displaced[rows[i][a]] != 0;
    return is;
  }
};

/// Where the children of divided leaves are, and where these were; −1 for leaves that are not among some. A call for each.
struct PlacesOfDivided {
  LeafParts const* parts;
  LeavesView leaves;
  Index *come, *go;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    auto const& own = parts[r];
    Index const before = own.cell - parts[0].cell;
    Index const first = leaves.places[own.cell] - leaves.first;
    if (leaves.has_others)  // some of which may be among the children of these
      for (Index k = 0; k < own.cells; ++k) {
        Index const place = leaves.places[own.cell + k] - leaves.first;
        come[before + k] = place >= 0 && place < leaves.count ? place : -1;
      }
    else
      for (Index k = 0; k < own.cells; ++k) come[before + k] = first + k;
    Index const from = leaves.from(first);
    go[r] = from >= 0 && from < leaves.count_before ? from : -1;
  }
};

/// Gives each leaf what was at its place before, in each of several columns; but for those that were of another type.
template <class U>
struct InheritValues {
  LeavesView leaves;
  U const* from;
  U* to;
  Index columns;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (leaves.comes_from_others(i)) return;
    for (Index k = 0; k < columns; ++k)
      to[static_cast<std::ptrdiff_t>(leaves.count) * k + i] =
          from[static_cast<std::ptrdiff_t>(leaves.count_before) * k + leaves.from(i)];
  }
};
/// The value of an element that was merged from so many, as Transfer gives it: of integers the most frequent, of equal ones the first;
/// else the mean by volume. Without volumes all count alike.
template <class U>
PLIANT_HOST_DEVICE U merged_value(U const* values, U const* volumes, Index count) {
  if constexpr (std::is_integral_v<U> || std::is_enum_v<U>) {
    Index best = 0, most = 0;
    for (Index i = 0; i < count; ++i) {
      Index equal = 0;
      for (Index j = 0; j < count; ++j) equal += values[j] == values[i];
      if (equal > most) {
        most = equal;
        best = i;
      }
    }
    return values[best];
  } else {
    auto const volume_of = [&](Index i) { return volumes == nullptr ? U(1) : volumes[i]; };
    U volume = 0, sum = 0;
    for (Index i = 0; i < count; ++i) volume += volume_of(i);
    bool same = true;  // what all have is not rounded
    for (Index i = 0; i < count; ++i) {
      same = same && values[i] == values[0];
      Uncontracted const share = volume_of(i) / volume;
      sum += static_cast<U>((share * Uncontracted(values[i])).value);
    }
    return same ? values[0] : sum;
  }
}
/// Gives merged leaves theirs.
template <class U>
struct MergeValues {
  LeavesView leaves;
  U const* from;
  U const* volumes;  // by the place before; null: children have the same
  U* to;
  Index columns;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const children = leaves.children(r), place = leaves.merged_place(r),
                first = leaves.first_child_before(r);
    for (Index k = 0; k < columns && children > 0; ++k)
      to[static_cast<std::ptrdiff_t>(leaves.count) * k + place] =
          merged_value(from + static_cast<std::ptrdiff_t>(leaves.count_before) * k + first,
                       volumes == nullptr ? nullptr : volumes + first, children);
  }
};

}  // namespace detail

/// The rows of nodes of all elements after a change, for elements_of_rows: (elements, Width). Those of leaves that were
/// there before are taken from `before`, the rows of the table of then; without nodes there, all come from the tree.
/// `of_node`: the row of each node, by the user's number, in the backend's memory.
template <Element E, int Width, Backend B>
typename B::template Array<Index> element_rows(B const& backend, TreeView const& tree,
                                               LeavesView const& leaves, Index const* of_node,
                                               ElementRows const& before = {nullptr, Width}) {
  static_assert(Width >= E::nodes);
  auto rows = unset<Index>(backend, static_cast<std::size_t>(leaves.count) * Width);
  backend.for_each(leaves.count,
                   detail::PutElementRows<E, Width>{tree, leaves, before, of_node, rows.data()});
  return rows;
}

/// The blocks of the elements after a change, the first of each; those of which no leaf was divided or merged stay, which are those
/// with as many leaves as before. `first_before`: the same before it. `staying`: where leaves go and others come, how many before each
/// block stay.
inline ElementBlocks blocks_after_change(std::vector<Index> first, std::vector<Index> first_before,
                                         std::vector<Index> const& staying = {}) {
  ElementBlocks blocks{std::move(first), {}, std::move(first_before)};
  auto const &now = blocks.first, &then = blocks.first_before;
  blocks.stays.resize(now.size() - 1);
  for (std::size_t b = 0; b + 1 < now.size(); ++b)
    blocks.stays[b] = now[b + 1] - now[b] == then[b + 1] - then[b] &&
                      (staying.empty() || staying[b + 1] - staying[b] == then[b + 1] - then[b]);
  return blocks;
}

/// Values per element after a change, (columns, elements): each has those that it had before, or that its parent had. Merged
/// ones have the most frequent of their children's, of equal ones the first, where values are integers; of others the mean
/// by `volumes` of the elements before, by their places, in the backend's memory. Without volumes all children count alike.
template <class U, Backend B>
typename B::template Array<U> inherited_values(B const& backend, LeavesView const& leaves,
                                               U const* before, Index columns = 1,
                                               U const* volumes = nullptr) {
  auto values =
      unset<U>(backend, static_cast<std::size_t>(leaves.count) * static_cast<std::size_t>(columns));
  backend.for_each(leaves.count, detail::InheritValues<U>{leaves, before, values.data(), columns});
  backend.for_each(leaves.merged,
                   detail::MergeValues<U>{leaves, before, volumes, values.data(), columns});
  return values;
}

/// The places of the elements that come in a refinement, and of those that go, before it, in a backend's memory: of those that are
/// among some leaves; −1 in the place of others.
template <Backend B>
struct RefinedPlaces {
  Index come_count, go_count;
  typename B::template Array<Index> come, go;

  /// By the leaves that it divided, into `children` in all. Waits for nothing.
  RefinedPlaces(B const& backend, LeavesView const& leaves,
                typename TreeOn<B>::Refined const& refined, Index children)
      : come_count(children),
        go_count(refined.leaves),
        come(unset<Index>(backend, static_cast<std::size_t>(come_count))),
        go(unset<Index>(backend, static_cast<std::size_t>(go_count))) {
    backend.for_each(go_count,
                     detail::PlacesOfDivided{refined.parts, leaves, come.data(), go.data()});
  }
};

}  // namespace pliant

#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/body/touched_elements.hpp>
#include <pliant/topology/changed_elements.hpp>

// Where a change of the mesh changes elements, for the bounds of frequencies that an integrator's step was chosen by.
namespace pliant {

/// Rows of nodes at which elements came or went, or which hang otherwise now.
template <Backend B>
struct ChangedRows {
  typename B::template Array<std::uint8_t> marks{};  // (rows); empty where nobody asks
  bool nodes_went = false;                           // so that the mesh may be coarser than it was
  bool displaces = false;                            // nodes that stay, as they begin to hang
  Index most = 0;                                    // no more are marked
};

namespace detail {

/// Whether the step of a body was chosen by bounds that hold in its present state, those of rows no worse than a tenth of the
/// step: a change of the mesh raises these, in place of having all elements looked at again. Local time steps have other bounds.
template <class Parts>
bool has_bounds_of_rows(Parts const& parts) {
  constexpr double no_worse = 1.21;
  auto const& own = parts.state.integrator;
  auto const& bounds = parts.state.bounds;
  return parts.raise_bounds != nullptr && own.active && own.macro_step == 0 &&
         own.asked_step == 0 && parts.state.steps < own.next_refresh && bounds.rows > 0 &&
         bounds.rows <= no_worse * bounds.elements;
}

/// Marks the nodes of elements that come in a change.
template <class Members>
struct MarkMembers {
  Members members;
  std::uint8_t* marks;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (!members.is_one(i)) return;
    for (Index const row : members.rows(i)) atomic_store(marks[row], 1);
  }
};
/// Of a body before a change; empty where its step does not stand on bounds of rows. `rows`: how many fields have behind it;
/// `merges`: whether elements are merged; families are told type by type.
template <class Parts, ChangedFamilies... Families>
ChangedRows<typename Parts::backend_type> changed_rows(Parts const& parts, Index rows, bool merges,
                                                       Families const&... families) {
  if (!has_bounds_of_rows(parts)) return {};
  auto marks = zeros<std::uint8_t>(parts.backend, static_cast<std::size_t>(rows));
  Index most = 0;
  auto const mark = [&]<class Own>(Own const& own) {
    MembersOf<Own, true> const members{own};
    parts.backend.for_each(members.places(),
                           MarkMembers<MembersOf<Own, true>>{members, marks.data()});
    most += Own::come_element::nodes * members.places();
  };
  (mark(families), ...);
  return {std::move(marks), merges, merges, most};
}
/// The same of nodes, by the user's numbers behind a change.
template <class Parts>
ChangedRows<typename Parts::backend_type> changed_rows(Parts const& parts,
                                                       typename Parts::layout_type const& layout,
                                                       std::vector<Index> const& nodes,
                                                       bool nodes_went, bool displaces) {
  if (!has_bounds_of_rows(parts)) return {};
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(layout.rows), 0);
  for (Index const node : nodes) marks[static_cast<std::size_t>(layout.internal_of(node))] = 1;
  return {upload(parts.backend, marks), nodes_went, displaces, static_cast<Index>(nodes.size())};
}

}  // namespace detail

}  // namespace pliant

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/is_marked.hpp>
#include <pliant/backend/patch_list.hpp>
#include <pliant/body/changed_rows.hpp>
#include <pliant/solver/stable_step.hpp>
#include <pliant/solver/stiffening.hpp>

// Bounds of frequencies behind a change of the mesh, at a cost in proportion to what it changes.
namespace pliant::detail {

/// Marks a node where another one of its row in an interpolation is marked.
struct MarkBesideMarked {
  Index const *node, *first, *other;
  std::uint8_t* marks;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    std::uint8_t any = marks[node[k]];
    for (Index j = first[k]; j < first[k + 1]; ++j) any |= marks[other[j]];
    marks[node[k]] = any;
  }
};
/// Marks the masters of marked slaves, then the slaves of marked masters.
template <Backend B>
void mark_over_interpolation(B const& backend, InterpolationOn<B> const& interpolation,
                             std::uint8_t* marks) {
  for (auto const* rows : {&interpolation.masters(), &interpolation.slaves()})
    if (rows->count > 0)
      backend.for_each(rows->count, MarkBesideMarked{rows->node.data(), rows->first.data(),
                                                     rows->other.data(), marks});
}

/// Marks all nodes of elements that have a marked one.
template <int Nodes>
struct MarkNodesOfMarked {
  HasMarkedNode<Nodes> has;
  std::uint8_t* to;
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    if (!has(e)) return;
    for (int a = 0; a < Nodes; ++a) atomic_set(to[has.rows[e][a]], 1);
  }
};
/// Marks the patches of elements that have a marked node.
template <int Nodes>
struct MarkPatchesOfMarked {
  HasMarkedNode<Nodes> has;
  PatchRanges patches;
  std::uint8_t* to;
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    if (has(e)) atomic_set(to[patches.patch_of(e)], 1);
  }
};
/// f(i) where i is marked, else 0.
template <class F>
struct AtMarked {
  IsMarked<std::uint8_t> is_marked;
  F f;
  PLIANT_HOST_DEVICE double operator()(Index i) const { return is_marked(i) ? f(i) : 0; }
};

/// Marks all rows that a change of the mesh changes, of marks of those at which it changes elements: of all nodes of elements
/// there, where nodes that begin to hang are displaced; of their masters; and of what hands rows on to these.
template <class Parts>
void spread_marks(Parts const& parts, ChangedRows<typename Parts::backend_type>& changed) {
  using B = typename Parts::backend_type;
  auto const& backend = parts.backend;
  auto const& interpolation = parts.layout.interpolation;
  mark_over_interpolation(backend, interpolation, changed.marks.data());
  if (!changed.displaces) return;
  auto seeds = unset<std::uint8_t>(backend, changed.marks.size());
  copy_values<B, std::uint8_t>(backend, std::as_const(changed.marks).data(), seeds.data(),
                               seeds.size());
  parts.for_each_type([&](auto const& table, auto const&) {
    constexpr int nodes = std::remove_cvref_t<decltype(table)>::element::nodes;
    backend.for_each(table.count(),
                     MarkNodesOfMarked<nodes>{{table.elements.rows_of_nodes(), seeds.data()},
                                              changed.marks.data()});
  });
  mark_over_interpolation(backend, interpolation, changed.marks.data());
}

/// Sums of marked rows, those of slaves handed on, by the elements that have a part in one, of which patches are listed; of
/// other rows a part. (nodes, 4) and scratch rows.
template <class Parts>
auto sums_of_marked_rows(Parts const& parts, std::uint8_t const* marks) {
  using T = typename Parts::T;
  auto const& backend = parts.backend;
  auto const at = parts.here();
  auto sums = zeros<T>(backend, parts.layout.f.size());
  NodeField<T, Parts::dim> const rows{sums.data()};
  for_each_added_term(parts, [&](auto const& term) { term.add_row_sums(backend, at, rows); });
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0) return;
    auto const count = table.elements.patch_count();
    auto patches = zeros<std::uint8_t>(backend, static_cast<std::size_t>(count));
    auto list = unset<Index>(backend, static_cast<std::size_t>(count) + 1);
    HasMarkedNode<Table::element::nodes> const has_marked{table.elements.rows_of_nodes(), marks};
    backend.for_each(table.count(), MarkPatchesOfMarked<Table::element::nodes>{
                                        has_marked, table.elements.patches(), patches.data()});
    backend.select(count, IsMarked<std::uint8_t>{patches.data()}, list.data() + 1, list.data());
    backend.template accumulate<Table::groups>(
        over(table.elements, list), RowSumKernel<typename Table::Laws>{table.laws, has_marked},
        rows, at.rest, at.u);
  });
  parts.layout.interpolation.hand_on_magnitudes(backend, rows);
  return sums;
}

/// The bound by rows, 1/s², of what a change of the mesh changed.
template <class Parts>
double bound_of_changed_rows(Parts const& parts,
                             ChangedRows<typename Parts::backend_type>& changed) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& layout = parts.layout;
  spread_marks(parts, changed);
  auto const sums = sums_of_marked_rows(parts, changed.marks.data());
  return layout.interpolation.magnitude() *
         parts.backend.maximum(
             layout.rows,
             AtMarked<RowOverMass<T, dim>>{
                 {changed.marks.data()}, {{sums.data()}, layout.mass.data(), layout.held.data()}});
}

/// Raises the bounds by which the step of a body was chosen by those of what a change of its mesh changed, for the parts behind
/// it, in place of a step that all elements are looked at for. Where nodes went, a longer step may be possible: that is
/// asked for within some steps, which take less time than to look at all elements behind each change. Whether elements are
/// distorted so that all have to be looked at in any case is seen by the next step, if it is time to: before this only where
/// that takes less time than to sum the rows.
template <class Parts>
void raise_bounds(Parts const& before, Parts& next,
                  ChangedRows<typename Parts::backend_type>& changed) {
  constexpr std::int64_t steps_until_longer = 128, most_of_few = 16;
  auto& state = next.state;
  auto& own = state.integrator;
  bool const changes_many = most_of_few * std::int64_t{changed.most} > next.layout.rows;
  if (next.layout.interpolation.magnitude() != before.layout.interpolation.magnitude() ||
      (changes_many && state.steps >= own.next_watch && asks_for_step(next)))
    return;
  double const bound = bound_of_changed_rows(next, changed);
  if (!std::isfinite(bound)) return;  // whoever asks for a step says why there is none
  state.bounds = {std::numeric_limits<double>::infinity(),
                  std::max(before.state.bounds.rows, bound)};
  own.bounds_raised = true;
  own.next_refresh = before.state.integrator.next_refresh;
  if (changed.nodes_went)
    own.next_refresh = std::min(own.next_refresh, state.steps + steps_until_longer);
}

}  // namespace pliant::detail

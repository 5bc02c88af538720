#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/adaptation/relaxation.hpp>

// Marks of what is not at rest.
namespace pliant::detail {

/// Marks the pieces of patches at nodes that are not at rest: faster than a speed, or pulled so that they would be within a
/// time.
template <class T, int Dim>
struct MarkStirred {
  NodeField<T const, Dim> v, f, kept;  // kept: of sleeping patches; may have no data
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  T below, time;  // m/s, s
  Index const *first, *pieces;
  std::uint8_t* stirred;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0))) return;  // masters of a slave tell
    auto pull = f.at(i);
    if (kept.data) pull = pull + kept.at(i);
    auto const velocity = v.at(i);
    T speed = T(0), gain = T(0);
    for (int k = 0; k < Dim; ++k) {
      if (held[i] >> k & 1) continue;
      T force = pull[k];
      if (external.load) force += NodeField<T const, Dim>{external.load}(i, k);
      T const a = acceleration_in(force, T(1) / m, external.gravity[k]);
      speed += velocity[k] * velocity[k];
      gain += a * a;
    }
    // NaN stirs.
    if (speed <= below * below && time * time * gain <= below * below) return;
    for (Index k = first[i]; k < first[i + 1]; ++k) set_flag(stirred[pieces[k]]);
  }
};

/// Marks the pieces beside those of one mark, where there is no mark yet, by the next one.
struct MarkBeside {
  Index const *first, *beside;
  std::uint8_t* marks;
  std::uint8_t mark;

  PLIANT_HOST_DEVICE void operator()(Index p) const {
    if (flag_of(marks[p]) != mark) return;
    for (Index k = first[p]; k < first[p + 1]; ++k)
      if (auto& other = marks[beside[k]]; flag_of(other) == 0)
        set_flag(other, static_cast<std::uint8_t>(mark + 1));
  }
};

struct ClearMarks {
  std::uint8_t* marks;
  PLIANT_HOST_DEVICE void operator()(Index piece) const { marks[piece] = 0; }
};

/// Patches with driven nodes do not sleep: marks their pieces at these, and no others, where conditions have changed since
/// looks began with them.
template <class Parts>
void mark_driven(Parts& parts) {
  auto& rows = *parts.patch_nodes;
  if (rows.driven_by == parts.state.prescribed.handle()) return;
  for (auto* marks : {rows.driven.data(), rows.stirred.data()}) {
    parts.backend.for_each(rows.pieces_count(), ClearMarks{marks});
    for (auto const& driven : parts.driven)
      parts.backend.for_each(
          static_cast<Index>(driven.rows().size()),
          MarkAtNodes{driven.rows().data(), rows.first.data(), rows.pieces.data(), marks});
  }
  rows.driven_by = parts.state.prescribed.handle();
}

/// Marks the pieces of patches that are not at rest, by 1, so many rings of neighbours around them, by more, and leaves the
/// others, at 0. The neighbours, if they slept, would throw a wave back that comes before the next look.
template <class Parts>
void mark_stirred(Parts& parts, SleepRule const& rule, int rings) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& backend = parts.backend;
  auto& rows = *parts.patch_nodes;
  evaluate_forces(parts);
  mark_driven(parts);
  NodeField<T const, dim> const kept{
      parts.awake && !parts.forces_complete ? parts.awake->kept.data() : nullptr};
  for_each_moving_node(
      parts, MarkStirred<T, dim>{
                 std::as_const(parts).v(),
                 {parts.layout.f.data()},
                 kept,
                 parts.layout.mass.data(),
                 parts.layout.held.data(),
                 external_forces(parts),
                 static_cast<T>(rule.below),
                 static_cast<T>(parts.state.integrator.step * static_cast<double>(rule.for_steps)),
                 rows.first.data(),
                 rows.pieces.data(),
                 rows.stirred.data()});
  for (int ring = 0; ring < rings; ++ring)
    backend.for_each(rows.pieces_count(),
                     MarkBeside{rows.first_beside.data(), rows.beside.data(), rows.stirred.data(),
                                static_cast<std::uint8_t>(ring + 1)});
}

}  // namespace pliant::detail

#pragma once

#include <concepts>

namespace pliant {

/// Whether a law, or a formulation, is defined where elements are flat or inverted, J = det F ≤ 0: its
/// energy and stress are finite there. A law says so by `static constexpr bool takes_inversion = true`.
/// All others, and those that say nothing, are for J > 0: no energy and no stress of a law of Pliant is
/// finite then for J ≤ 0, so that no solver takes such a state for an answer. A law with powers of J takes
/// them of `positive_or_nan(1 + i.J_minus_1)`. A logarithm of J makes the energy NaN by itself, but its
/// slope 1/J is finite: the stress is NaN too where a square of the logarithm is there.
template <class L>
inline constexpr bool takes_inversion = false;
template <class L>
  requires requires {
    { L::takes_inversion } -> std::convertible_to<bool>;
  }
inline constexpr bool takes_inversion<L> = L::takes_inversion;

}  // namespace pliant

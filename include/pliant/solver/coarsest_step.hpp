#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include <pliant/body/step_schedule.hpp>
#include <pliant/solver/element_limits.hpp>

// The step of level 0 of local time steps.
namespace pliant::detail {

inline constexpr int limit_bins_per_octave = 16;

/// Sorts patches by the stable step of their finest element over the shortest of all, on a logarithmic scale.
template <class T>
struct LimitBin {
  T const* squared_frequency;
  double largest;
  PatchRanges patches;
  PLIANT_HOST_DEVICE Bin operator()(Index p) const {
    Index const first = patches.first[p], last = patches.first[p + 1];
    T highest = T(0);
    for (Index e = first; e < last; ++e) highest = max(highest, squared_frequency[e]);
    double const x = static_cast<double>(highest);
    double bin = histogram_bins - 1;
    if (x > 0) bin = min(bin, limit_bins_per_octave / 2 * std::log2(largest / x) + 1e-6);
    return {static_cast<int>(bin), last - first};
  }
};

using LimitCounts = std::array<std::int64_t, histogram_bins>;

/// How many elements have which stable step, as bound_elements left it, with the largest of these bounds.
template <class Parts>
LimitCounts count_limits(Parts& parts, double largest) {
  auto bins = zeros<std::int64_t>(parts.backend, histogram_bins);
  parts.for_each_type([&](auto& table, auto&) {
    parts.backend.histogram(
        table.elements.patch_count(),
        LimitBin<typename Parts::T>{table.scratch.data(), largest, table.elements.patches()},
        bins.data());
  });
  LimitCounts counts{};
  bins.download(counts);
  return counts;
}

/// Element evaluations per second with a stable step of level 0, where the shortest stable step is `shortest`;
/// infinite for steps of no length and for too many levels.
inline double cost_of(LimitCounts const& counts, double shortest, double step) {
  double const bin = limit_bins_per_octave * std::log2(step / shortest);
  if (!(step > 0) || bin > limit_bins_per_octave * most_step_levels)
    return std::numeric_limits<double>::infinity();
  double cost = 0;
  for (int b = 0; b < histogram_bins; ++b) {
    auto const count = counts[static_cast<std::size_t>(b)];
    if (count == 0) continue;  // as of most
    double const level = std::max(0.0, std::ceil((bin - b) / limit_bins_per_octave - 1e-6));
    cost += static_cast<double>(count) * std::exp2(level);
  }
  return cost / step;
}

/// The stable step of level 0 for which steps take the fewest evaluations, s, with the elements' bounds left as
/// bound_elements does: of both ways to share mass out, the cheaper one. The present macro step stays until
/// another takes a fifth fewer; one that is given (s; else 0) stays.
template <class Parts>
double choose_coarsest_step(Parts& parts, double macro_step, double safety) {
  double const given = (macro_step > 0 ? macro_step : parts.state.integrator.macro_step) / safety;
  double present[2], best[2], step[2];
  for (MassShares shares : {MassShares::own, MassShares::by_rows}) {
    auto const k = static_cast<std::size_t>(shares);
    double const largest = bound_elements(parts, shares);
    auto const counts = count_limits(parts, largest);
    double const shortest = 2 / std::sqrt(largest);
    present[k] = cost_of(counts, shortest, given);
    best[k] = std::numeric_limits<double>::infinity();
    for (int b = 0; b <= most_step_levels * limit_bins_per_octave; ++b) {
      double const t = shortest * std::exp2(static_cast<double>(b) / limit_bins_per_octave);
      double const cost = cost_of(counts, shortest, t);
      if (cost >= best[k]) continue;
      best[k] = cost;
      step[k] = t;
    }
  }
  bool const stays =
      macro_step > 0 || std::min(present[0], present[1]) <= 1.25 * std::min(best[0], best[1]);
  auto const& cost = stays ? present : best;
  auto const cheaper = cost[0] <= cost[1] ? MassShares::own : MassShares::by_rows;
  if (!std::isfinite(cost[static_cast<std::size_t>(cheaper)]))
    throw Error("LocalSteps: a macro step of ", macro_step, " s is more than 2^", most_step_levels,
                " of the shortest stable steps; give a shorter one");
  if (cheaper == MassShares::own) (void)bound_elements(parts, cheaper);
  return stays ? given : step[static_cast<std::size_t>(cheaper)];
}

}  // namespace pliant::detail

#pragma once

#include <pliant/body/step_schedule.hpp>
#include <pliant/solver/distortion.hpp>
#include <pliant/solver/element_limits.hpp>

// Levels of local time steps: of elements from their own stable steps, in the backend's memory.
namespace pliant {

namespace detail {

/// The level that an element needs. It goes down only when its stable step is longer than that level needs
/// by `margin`, so that one near a power of two does not go back and forth.
template <class T>
struct AssignLevel {
  T const* squared_frequency;
  StepLevel* level;
  double coarsest;  // 1/s²: the largest squared frequency of level 0
  double margin;    // 1 and a share

  PLIANT_HOST_DEVICE double level_for(double x) const {
    return min(static_cast<double>(most_step_levels),
               max(0.0, std::ceil(std::log2(x / coarsest) / 2 - 1e-6)));
  }
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    double const x = static_cast<double>(squared_frequency[e]);
    if (!(x > 0)) {
      level[e] = 0;
      return;
    }
    double const present = level[e];
    level[e] =
        static_cast<StepLevel>(max(level_for(x), min(present, level_for(x * margin * margin))));
  }
};

/// 2^(8 level): sums of these over fewer than 256 elements tell the highest level.
PLIANT_HOST_DEVICE double level_to_weight(int level) {
  double weight = 1;
  for (int k = 0; k < level; ++k) weight *= 256;
  return weight;
}
PLIANT_HOST_DEVICE int weight_to_level(double sum) {
  int level = 0;
  for (; sum >= 256; sum /= 256) ++level;
  return level;
}

template <class T>
struct LevelsToWeights {
  StepLevel const* level;
  T* weight;
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    weight[e] = static_cast<T>(level_to_weight(level[e]));
  }
};
/// Adds the weight of each element to its nodes.
template <class T>
struct SpreadWeight {
  static constexpr bool reads_elements = true;
  ElementField<T const, 1> weights;
  template <int G, class Own, class S, int N, int C>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, Own const& own, Matrix<S, N, C> const&) const {
    auto const weight = own(weights);
    Matrix<S, N, 1> out;
    for (int a = 0; a < N; ++a) out(a, 0) = weight[0];
    return out;
  }
};
/// Sums of weights become levels, at least `least` where a term acts.
template <class T>
struct SumsToLevels {
  NodeField<T, 1> field;
  StepLevel const* touched;  // by terms; may be null
  int least;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    int const level = weight_to_level(static_cast<double>(field(i, 0)));
    field(i, 0) = static_cast<T>(touched && touched[i] ? max(level, least) : level);
  }
};
template <class T>
struct TouchedLevel {
  NodeField<T, 1> field;
  StepLevel const* touched;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return touched[i] ? weight_to_level(static_cast<double>(field(i, 0))) : 0;
  }
};
/// The highest level of an element's nodes becomes its own.
template <class T>
struct TakeHighest {
  static constexpr int counters = 0;
  T* weights;  // (elements)
  template <int G, class S, int N>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Matrix<S, N, 1> const& x) const {
    Vector<S, 1> highest;
    highest[0] = x(0, 0);
    for (int a = 1; a < N; ++a) highest[0] = max(highest[0], x(a, 0));
    return highest;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& highest, Again const&,
                                 Tally const&) const {
    weights[e] = static_cast<T>(level_to_weight(static_cast<int>(highest[0])));
  }
};
/// A patch steps with its finest element: so do the others in it.
template <class T>
struct RaisePatch {
  T* weights;         // (elements)
  StepLevel* levels;  // (patches)
  PatchRanges patches;
  PLIANT_HOST_DEVICE void operator()(Index p) const {
    Index const first = patches.first[p], last = patches.first[p + 1];
    T highest = T(1);
    for (Index e = first; e < last; ++e) highest = max(highest, weights[e]);
    for (Index e = first; e < last; ++e) weights[e] = highest;
    levels[p] = static_cast<StepLevel>(weight_to_level(static_cast<double>(highest)));
  }
};
/// How many of the finest steps are in that of an element.
template <class T>
struct LevelsToShares {
  T const* weights;  // see LevelsToWeights
  int finest;
  T* shares;
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    int const level = weight_to_level(static_cast<double>(weights[e]));
    shares[e] = static_cast<T>(Index{1} << (finest - level));
  }
};
template <class T>
struct TakeLevel {
  NodeField<T, 1> field;
  StepLevel* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = static_cast<StepLevel>(field(i, 0)); }
};
/// How much a distortion changed, against what it was.
template <class T>
struct DistortionChange {
  T const *present, *before;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    double const was = static_cast<double>(before[e]);
    return infinite_if_not_finite(std::abs(static_cast<double>(present[e]) - was) / (1 + was));
  }
};
struct DifferentTag {
  Tag const *a, *b;
  PLIANT_HOST_DEVICE double operator()(Index e) const { return a[e] != b[e]; }
};

/// Keeps how distorted elements are, for those levels that are chosen now.
template <class Parts>
void keep_distortions(Parts& parts) {
  using T = typename Parts::T;
  parts.for_each_type([&](auto& table, auto& elements) {
    auto const count = static_cast<std::size_t>(table.count());
    if (elements.step_distortions.size() != count)
      elements.step_distortions = zeros<T>(parts.backend, count);
    if (count == 0) return;
    evaluate_distortion(parts, table);
    parts.backend.for_each(table.count(),
                           CopyValue<T>{table.scratch.data(), elements.step_distortions.data()});
  });
}
/// By which share of 1 + distortion an element's changed since then, the largest.
template <class Parts>
double distortion_change(Parts& parts) {
  double largest = 0;
  parts.for_each_type([&](auto& table, auto& elements) {
    if (table.count() == 0) return;
    evaluate_distortion(parts, table);
    largest = std::max(
        largest, parts.backend.maximum(
                     table.count(), DistortionChange<typename Parts::T>{
                                        table.scratch.data(), elements.step_distortions.data()}));
  });
  return largest;
}

}  // namespace detail
}  // namespace pliant

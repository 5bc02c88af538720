#pragma once

#include <cstdint>

#include <pliant/backend/patch_ranges.hpp>
#include <pliant/force/element_kernels.hpp>

// Forces tell on their way which elements a look has to look at.
namespace pliant::detail {

/// f(element) for those that a kernel computes together.
template <class Own, class F>
PLIANT_HOST_DEVICE void for_each_element(Own const& own, F const& f) {
  if constexpr (requires { own.element[0]; })
    for (int l = 0; l < own.count; ++l) f(own.element[l]);
  else
    f(own.element);
}

/// Which elements of a table are near some that may act, by their squared displacement gradients H:H. What is noted is
/// the step of the look, so that nothing has to be cleared.
template <class T, int Groups>
struct Screen {
  T above[Groups], below[Groups];  // H:H between which elements of a group may act, if any
  std::int64_t* noted;             // (runs of elements, see PatchRanges)
  std::int64_t const* step;        // (1): of the look

  /// Notes the runs of elements of group G if one of them may act; NaN does not.
  template <int G, class S, class Own>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, S const& squared, Own const& own) const {
    if (any_less(S(above[G]), select(S(below[G]) < squared, S(-1), squared)))
      for_each_element(own, [&](Index e) { noted[e / PatchRanges::run] = *step; });
  }
  PLIANT_HOST_DEVICE bool selects(Index element) const {
    return noted[element / PatchRanges::run] == *step;
  }
  /// On the host: whether elements of [first, last) are selected.
  bool selects_some(Index first, Index last) const {
    for (Index e = first; e < last; e += PatchRanges::run - e % PatchRanges::run)
      if (selects(e)) return true;
    return false;
  }
};

/// The forces of linear simplices, which a screen sees.
template <class Laws, Geometry How, class TheScreen>
struct ScreenedForceKernel {
  static constexpr bool reads_elements = true;
  static constexpr bool few_operations = Laws::few_operations;
  static constexpr bool symmetric = Laws::symmetric;
  ForceKernel<Laws, How> force;
  TheScreen screen;

  template <int G, class Own, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G> group, Own const& own, V const& rest,
                                     V const& u) const {
    using E = typename Laws::template formulation<G>::element;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    static constexpr auto table = tabulate<E, Gauss<1>, builtin_scalar<S>>();
    auto const h = RestMap<E, S, How>::at(Coefficients<E, S>::of(rest), table, 0)
                       .gradient(Coefficients<E, S>::of(u), table, 0);
    screen(group, dot(h, h), own);
    return call(force, group, own, rest, u);
  }
};

}  // namespace pliant::detail

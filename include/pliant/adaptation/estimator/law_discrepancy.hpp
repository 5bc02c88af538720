#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/formulation/point_stress.hpp>

namespace pliant {

namespace detail {
/// ∫ |P_to − P|² dV over an element, by the rule of F, beside each of some laws; stresses under `to` are found once.
template <class F, class State, class To, class... Laws>
PLIANT_HOST_DEVICE auto squared_differences(State const& e, To const& to, Laws const&... laws) {
  using S = typename State::scalar;
  auto sums = Vector<S, int{sizeof...(Laws)}>::zero();
  for_each_point_of<F>(e.rest, e.u,
                       [&](int q, S const& volume, Tensor<S, F::dim> const& h) PLIANT_INLINE {
                         auto const there = stress(point_law(to, q), h);
                         int k = 0;
                         auto const add = [&](auto const& law) PLIANT_INLINE {
                           auto const off = there - stress(point_law(law, q), h);
                           sums[k] = sums[k] + volume * dot(off, off);
                           ++k;
                         };
                         (add(laws), ...);
                       });
  return sums;
}
}  // namespace detail

/// What an element's law gets wrong beside that of the Group<To>, J: ∫ |P_to − P|²/(2E) dV over the element, of
/// the first Piola-Kirchhoff stresses at its present deformation, with Young's modulus E of its own law at rest. Both
/// ways round it is a rule for switching: a cheaper law is good enough where `LawDiscrepancy<Cheaper>` is small.
template <class To>
struct LawDiscrepancy {
  static constexpr Unit unit = Unit::joule;
  static constexpr bool reads_young = true;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    static_assert(std::same_as<typename F::element, typename To::element>,
                  "LawDiscrepancy<To>: To is a formulation on the same element");
    static_assert(
        keeps_internal_variables<F, To>,
        "LawDiscrepancy<To>: To has the internal variables of the element's own law, at the same "
        "points, or none");
    auto const squared = detail::squared_differences<F>(e, e.template law_of<To>(), e.law)[0];
    return T(0.5) * squared / e.young();
  }
};

}  // namespace pliant

#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/formulation/point_stress.hpp>

namespace pliant {

/// What an element's rule gets wrong beside a richer one, J: ½ |Δf|⁴/(Δf·K Δf) with the difference Δf of the nodal
/// forces of To and its own and the stiffness K of To, at the present displacements. It is the energy that K
/// takes from Δf along Δf; the energy ½ Δf·K⁻¹ Δf of the displacements that Δf makes is no smaller, and the same where
/// Δf is an eigenvector, as in one hourglass of a rectangle. To is a formulation of the same element and law, with
/// a rule or scheme of its own; the body needs no Group of it. Uniform deformations give zero.
template <class To>
struct QuadratureDiscrepancy {
  static constexpr Unit unit = Unit::joule;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    static_assert(std::same_as<typename F::element, typename To::element> &&
                      std::same_as<typename F::template law<T>, typename To::template law<T>>,
                  "QuadratureDiscrepancy<To>: To is a formulation of the same element and law");
    static_assert(internal_variables_of<F> == 0,
                  "QuadratureDiscrepancy<To>: internal variables belong to the points of one rule");
    static_assert(!std::same_as<typename To::quadrature, OnePoint>,
                  "QuadratureDiscrepancy<To>: OnePoint is not the richer rule");
    decltype(auto) law = point_law(e.law, 0);
    auto const off = force<To>(law, e.rest, e.u) - force<F>(e.law, e.rest, e.u);
    S const squared = dot(off, off);
    S const stiffness = abs(dot(off, tangent_product<To>(law, e.rest, e.u, off)));
    return T(0.5) *
           select(S(0) < stiffness, squared / select(S(0) < stiffness, stiffness, S(1)), S(0)) *
           squared;
  }
};

}  // namespace pliant

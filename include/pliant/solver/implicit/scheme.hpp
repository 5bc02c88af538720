#pragma once

#include <cmath>
#include <concepts>

#include <pliant/error.hpp>

// What tells implicit integrators apart: how the velocity and the acceleration at the end of a step follow from its
// displacement, and where between its ends forces are in balance.
namespace pliant {

/// A step d = u' − u as equations of its end,
///   v' = velocity.d d + velocity.v v + velocity.a a + velocity.d_before (u − u₋) + velocity.v_before v₋
///   a' = the same with `acceleration`
/// where u₋ and v₋ are those of one step earlier, and balance is asked for at
///   u + force_weight d,  v + force_weight (v' − v),  a + inertia_weight (a' − a).
struct StepRule {
  struct Row {
    double d, v = 0, a = 0, d_before = 0, v_before = 0;
  };
  Row velocity, acceleration;
  double force_weight = 1, inertia_weight = 1;
  /// The part that d is too large by of what it has beyond the extrapolation h v + h²/2 a, or h v of first order, for short
  /// steps.
  double error_share = 0;
};

/// An implicit scheme: its rule of a step of size h, s, behind one of size h_before (0: there was none), its order,
/// and its name in messages.
template <class S>
concept ImplicitScheme = std::copy_constructible<S> && requires(S const& scheme, double h) {
  { scheme.rule(h, h) } -> std::same_as<StepRule>;
  { S::order } -> std::convertible_to<int>;
  { S::name } -> std::convertible_to<char const*>;
  { S::looks_back } -> std::convertible_to<bool>;  // whether it needs u₋ and v₋
  scheme.check();
};

/// v' = d/h, a' = (v' − v)/h: first order, damps all that is faster than its step. The one that stands most.
struct BackwardEuler {
  static constexpr int order = 1;
  static constexpr bool looks_back = false;
  static constexpr char const* name = "BackwardEuler";
  void check() const {}
  StepRule rule(double h, double) const {
    return {.velocity = {.d = 1 / h},
            .acceleration = {.d = 1 / (h * h), .v = -1 / h},
            .error_share = 0.5};
  }
};

/// d = h v + h² ((1/2 − β) a + β a'), v' = v + h ((1 − γ) a + γ a') (Newmark 1959). The trapezoidal rule, which these
/// numbers are: second order, unconditionally stable and without damping for small motions. In large ones its energy
/// may grow: watch it, or take γ > 1/2 with β = (γ + 1/2)²/4, first order.
struct Newmark {
  double beta = 0.25, gamma = 0.5;  // β in (0, 1], γ in [1/2, 1]

  static constexpr int order = 2;
  static constexpr bool looks_back = false;
  static constexpr char const* name = "Newmark";
  void check() const {
    if (!(beta > 0 && beta <= 1) || !(gamma >= 0.5 && gamma <= 1))
      throw Error("Newmark: beta ", beta, " and gamma ", gamma,
                  "; give beta above 0 up to 1, and gamma from 1/2 to 1");
  }
  StepRule rule(double h, double) const {
    StepRule::Row const a{.d = 1 / (beta * h * h), .v = -1 / (beta * h), .a = -(0.5 - beta) / beta};
    StepRule::Row const v{
        .d = gamma * h * a.d, .v = 1 + gamma * h * a.v, .a = h * (1 - gamma) + gamma * h * a.a};
    return {.velocity = v, .acceleration = a, .error_share = 1 - 1 / (6 * beta)};
  }
};

/// Newmark's formulas with balance between the ends of a step (Chung and Hulbert, Journal of Applied Mechanics 60
/// (1993) 371): second order, and the fastest modes keep `spectral_radius` of their amplitude from step to step:
/// 1 all, 0 nothing.
struct GeneralizedAlpha {
  double spectral_radius = 0.8;  // ρ∞ in [0, 1]

  static constexpr int order = 2;
  static constexpr bool looks_back = false;
  static constexpr char const* name = "GeneralizedAlpha";
  void check() const {
    if (!(spectral_radius >= 0 && spectral_radius <= 1))
      throw Error("GeneralizedAlpha: a spectral radius of ", spectral_radius,
                  "; give a number from 0 to 1");
  }
  StepRule rule(double h, double h_before) const {
    double const of_inertia = (2 * spectral_radius - 1) / (spectral_radius + 1);
    double const of_force = spectral_radius / (spectral_radius + 1);
    double const alpha = 1 - of_inertia + of_force;
    auto rule = Newmark{alpha * alpha / 4, alpha - 0.5}.rule(h, h_before);
    rule.inertia_weight = 1 - of_inertia;
    rule.force_weight = 1 - of_force;
    return rule;
  }
};

/// The backward differentiation formula of second order, for steps of any sizes; its first step is one of
/// BackwardEuler. It damps what is faster than its step, and slow motions little.
struct BDF2 {
  static constexpr int order = 2;
  static constexpr bool looks_back = true;
  static constexpr char const* name = "BDF2";
  void check() const {}
  StepRule rule(double h, double h_before) const {
    if (!(h_before > 0)) return BackwardEuler{}.rule(h, 0);
    double const ratio = h / h_before;
    double const now = (1 + 2 * ratio) / ((1 + ratio) * h), then = (1 + ratio) / h,
                 before = ratio * ratio / ((1 + ratio) * h);
    return {
        .velocity = {.d = now, .d_before = -before},
        .acceleration = {.d = now * now, .v = -then, .d_before = -now * before, .v_before = before},
        .error_share = 4.0 / 7};
  }
};

}  // namespace pliant

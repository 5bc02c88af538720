#pragma once

#include <pliant/solver/implicit/balance.hpp>

namespace pliant::detail {

/// How far displacements, velocities and accelerations are off, to first order: the errors of all steps so far, carried
/// along by the tangent of the motion. Errors grow as neighbouring motions part, be it that forces drive them apart or
/// that an impact leaves them another speed, and die out where these are damped. From the equations of a step (see StepRule)
/// and its balance r(d) = 0 follows that of the errors,
///   −∂r/∂d δd = ∂r/∂u δu + ∂r/∂v δv + ∂r/∂a δa,   δu' = δu + δd + l,
/// with the step's own error l; δv' and δa' follow from δd as v' and a' do from d.
template <class Parts>
class CarriedErrors {
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Field = typename Parts::Field;
  using Array = typename Parts::template Array<T>;

 public:
  CarriedErrors(Parts& parts, Balance<Parts>& balance, MassMatrix mass, double stiffness_damping)
      : parts_(parts),
        balance_(balance),
        mass_(mass),
        stiffness_damping_(stiffness_damping),
        nodes_(parts.layout.rows) {}

  /// Errors are none where a motion begins; `looks_back`: whether the scheme does.
  void begin(bool looks_back) {
    auto& kept = parts_.state.implicit;
    auto const make = [&](Array& array) {
      if (array.size() == 0) array = zeros<T>(parts_.backend, parts_.layout.rest.size());
    };
    for (auto* array : {&kept.error_u, &kept.error_v, &kept.error_a}) make(*array);
    if (!looks_back) return;
    make(kept.error_d_before);
    make(kept.error_v_before);
  }

  /// The right-hand side for δd, with the matrix of the step, into arrays().residual.
  void find_residual(StepRule const& rule) {
    auto& own = balance_.arrays();
    auto& kept = parts_.state.implicit;
    auto const speed = field(own.speed), w = field(own.acceleration);
    set_row(speed, rule.velocity, rule.force_weight, 0, kept.error_v);
    set_row(w, rule.acceleration, rule.inertia_weight, 0, kept.error_a);
    set(w, scaled(1, w), scaled(parts_.state.damping, speed));
    auto const u = std::as_const(parts_).u();
    auto const multiply = [&](double inertia, double stiffness, typename Parts::ConstField at,
                              Field x, Array& to) {
      ShiftedTangent<Parts>{inertia, mass_, stiffness, at, 0, u}.apply(parts_, x, field(to));
    };
    multiply(0, 1, {own.place.data()}, field(kept.error_u), own.image);
    multiply(1, 0, u, w, own.inert);
    double const s = stiffness_damping_;
    if (s != 0) multiply(0, s, u, speed, own.force);
    set(field(own.residual), scaled(-1, field(own.image)), scaled(-1, field(own.inert)),
        scaled(s != 0 ? -1 : 0, field(own.force)));
  }
  /// To the end of a step whose own error is `l`, with δd in arrays().solution. Returns the largest δu', m.
  double go_on(StepRule const& rule, bool looks_back, Field l) {
    auto& own = balance_.arrays();
    auto& kept = parts_.state.implicit;
    auto const d = field(own.solution), speed = field(own.speed), a = field(own.acceleration);
    set_row(speed, rule.velocity, 1, 1, kept.error_v);
    set_row(a, rule.acceleration, 1, 1, kept.error_a);
    set(field(kept.error_u), scaled(1, field(kept.error_u)), scaled(1, d), scaled(1, l));
    if (looks_back) {
      set(field(kept.error_d_before), scaled(1, d), scaled(1, l));
      set(field(kept.error_v_before), scaled(1, field(kept.error_v)));
    }
    set(field(kept.error_v), scaled(1, speed));
    set(field(kept.error_a), scaled(1, a));
    return parts_.backend.maximum(nodes_, LargestAt<T, dim>{{kept.error_u.data()}});
  }

 private:
  static Field field(Array& array) { return {array.data()}; }
  static Scaled<T, dim> scaled(double factor, Field field) { return {factor, {field.data}}; }
  template <class... Terms>
  void set(Field out, Terms const&... terms) const {
    set_sum(parts_.backend, nodes_, out, terms...);
  }
  /// out = weight · row + (1 − weight) · before, where δd counts `with_d` times.
  void set_row(Field out, StepRule::Row const& row, double weight, double with_d, Array& before) {
    auto& own = balance_.arrays();
    auto& kept = parts_.state.implicit;
    set(out, scaled(weight * with_d * row.d, field(own.solution)),
        scaled(weight * row.v, field(kept.error_v)), scaled(weight * row.a, field(kept.error_a)),
        scaled(weight * row.d_before, field(kept.error_d_before)),
        scaled(weight * row.v_before, field(kept.error_v_before)));
    if (weight != 1) set(out, scaled(1, out), scaled(1 - weight, field(before)));
  }

  Parts& parts_;
  Balance<Parts>& balance_;
  MassMatrix mass_;
  double stiffness_damping_;
  Index nodes_;
};

}  // namespace pliant::detail

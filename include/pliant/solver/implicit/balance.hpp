#pragma once

#include <pliant/constraint/conditions.hpp>
#include <pliant/solver/implicit/scheme.hpp>
#include <pliant/solver/linear/matrix_free.hpp>

namespace pliant::detail {

/// Subtracts one value at all nodes.
template <class T, int Dim>
struct TakeAway {
  NodeField<T, Dim> field;
  Vector<T, Dim> value;
  PLIANT_HOST_DEVICE void operator()(Index i) const { field.set(i, field.at(i) - value); }
};
/// Takes the values of another field in the directions that are held or driven.
template <class T, int Dim>
struct TakeHeld {
  NodeField<T, Dim> to;
  NodeField<T const, Dim> from;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k)
      if (held[i] >> k & 1) to(i, k) = from(i, k);
  }
};
/// Subtracts them there.
template <class T, int Dim>
struct LessHeld {
  NodeField<T, Dim> to;
  NodeField<T const, Dim> from;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k)
      if (held[i] >> k & 1) to(i, k) -= from(i, k);
  }
};
template <class T, int Dim>
struct DivideByMass {
  NodeField<T, Dim> field;
  T const* mass;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (mass[i] > T(0)) field.set(i, (T(1) / mass[i]) * field.at(i));
  }
};
/// The largest |factor field| of a direction.
template <class T, int Dim>
struct LargestAt {
  NodeField<T const, Dim> field;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    T most = T(0);
    auto const value = field.at(i);
    for (int k = 0; k < Dim; ++k) most = max(most, abs(value[k]));
    return infinite_if_not_finite(static_cast<double>(most));
  }
};

/// One direction of a field.
template <class T, int Dim>
struct ComponentAt {
  NodeField<T const, Dim> field;
  int direction;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return static_cast<double>(field(i, direction));
  }
};

/// The one residual of implicit steps, in the memory of a body's backend and in its precision:
///   r(d) = F(u_θ) + loads − M (a_θ + c v_θ − g) − s K(u) v_θ
/// over the unknowns, where θ marks what the scheme's rule makes of the step d (see StepRule), c is the mass damping and
/// s the stiffness damping.
template <class Parts>
class Balance {
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Field = typename Parts::Field;
  using ConstField = typename Parts::ConstField;
  using Arrays = SolverArrays<typename Parts::backend_type>;

 public:
  Balance(Parts& parts, MassMatrix mass, double stiffness_damping)
      : parts_(parts),
        mass_(mass),
        stiffness_damping_(stiffness_damping),
        nodes_(parts.layout.rows) {
    if (!parts.solver)
      parts.solver.emplace(parts.backend, parts.layout.rest.size(), parts.layout.f.size(), dim);
    else if (parts.solver->force.size() != parts.layout.f.size())
      parts.solver.emplace(parts.backend, parts.layout.rest.size(), parts.layout.f.size(), dim);
    weigh(field(arrays().residual));
    weight_ = norm(arrays().residual);
  }
  Arrays& arrays() { return *parts_.solver; }
  Field field(typename Parts::template Array<T>& array) const { return {array.data()}; }
  double norm(typename Parts::template Array<T>& array) const {
    return norm_of(parts_.backend, nodes_, field(array));
  }
  /// Weight and loads of the unknowns, N.
  void weigh(Field out) {
    auto const w = field(arrays().acceleration);
    clear_rows(parts_, field(arrays().force));
    clear_rows(parts_, w);
    (void)sum_up(w);
    set_sum(parts_.backend, nodes_, out, scaled(1, field(arrays().residual)));
  }

  /// The matrix −∂r/∂d.
  ShiftedTangent<Parts> matrix(StepRule const& rule) {
    return {inertia_factor(rule),
            mass_,
            rule.force_weight,
            {arrays().place.data()},
            stiffness_damping_ * rule.force_weight * rule.velocity.d,
            std::as_const(parts_).u()};
  }

  struct Size {
    double residual, scale;  // N: |r|, and the largest of what it is the sum of
  };
  /// r of the step d in arrays().increment, into arrays().residual.
  Size evaluate(StepRule const& rule) {
    auto& own = arrays();
    double const wf = rule.force_weight, wm = rule.inertia_weight;
    auto const d = field(own.increment), w = field(own.acceleration), speed = field(own.speed),
               place = field(own.place), f = field(own.force);
    set_row(speed, rule.velocity, wf);
    set_row(w, rule.acceleration, wm);
    set_sum(parts_.backend, nodes_, place, scaled(1, parts_.u()), scaled(wf, d));
    parts_.layout.interpolation.apply(parts_.backend, place, speed);
    clear_rows(parts_, f);
    for_each_force_term(parts_, [&](auto const& term) {
      term.add_force(parts_.backend, parts_.at({place.data}), f);
      if (stiffness_damping_ != 0)
        term.add_tangent_product(parts_.backend, static_cast<T>(stiffness_damping_), parts_.here(),
                                 {speed.data}, f);
    });
    parts_.layout.interpolation.apply_transpose(parts_.backend, f);
    set_sum(parts_.backend, nodes_, w, scaled(1, w), scaled(parts_.state.damping, speed));
    return sum_up(w);
  }
  /// Moves the step as a whole so that nothing is left of the residual's sum in directions in which no node is held or
  /// driven: iterations leave of it what their tolerance lets them, and so the body's momentum would wander. The residual
  /// in arrays() is of the step before that. Forces do not see a translation, but those of a user's terms may.
  void balance_translations(StepRule const& rule) {
    if (!parts_.terms.empty()) return;
    DirectionMask held = 0;
    for (auto const& condition : parts_.state.prescribed->conditions) held |= condition.directions;
    auto const r = field(arrays().residual), d = field(arrays().increment);
    double const inertia = inertia_factor(rule) * parts_.layout.mass_in_all;
    Vector<T, dim> too_far{};
    bool moves = false;
    for (int k = 0; k < dim; ++k) {
      if (held >> k & 1) continue;
      double const left = parts_.backend.sum(nodes_, ComponentAt<T, dim>{{r.data}, k});
      too_far[k] = static_cast<T>(-left / inertia);
      moves = moves || too_far[k] != T(0);
    }
    if (moves) parts_.backend.for_each(nodes_, TakeAway<T, dim>{d, too_far});
  }
  /// a in balance with forces at the present u and v, into state.implicit.a; zero where nodes are held or driven.
  void find_acceleration() {
    auto& own = arrays();
    auto const w = field(own.acceleration), f = field(own.force);
    clear_rows(parts_, f);
    for_each_force_term(parts_, [&](auto const& term) {
      term.add_force(parts_.backend, parts_.here(), f);
      if (stiffness_damping_ != 0)
        term.add_tangent_product(parts_.backend, static_cast<T>(stiffness_damping_), parts_.here(),
                                 std::as_const(parts_).v(), f);
    });
    parts_.layout.interpolation.apply_transpose(parts_.backend, f);
    set_sum(parts_.backend, nodes_, w, scaled(parts_.state.damping, parts_.v()));
    sum_up(w);
    auto const a = field(parts_.state.implicit.a);
    if (mass_ == MassMatrix::lumped) {
      set_sum(parts_.backend, nodes_, a, scaled(1, field(own.residual)));
      parts_.backend.for_each(nodes_, DivideByMass<T, dim>{a, parts_.layout.mass.data()});
    } else {
      ShiftedTangent<Parts> const masses{
          1, mass_, 0, std::as_const(parts_).u(), 0, std::as_const(parts_).u()};
      Preconditioning<Parts> by(Preconditioner::nodal_blocks);
      solve_matrix_free(parts_, own, masses, 8 * double{std::numeric_limits<T>::epsilon()}, 200,
                        by);
      set_sum(parts_.backend, nodes_, a, scaled(1, field(own.solution)));
    }
    parts_.layout.interpolation.apply(parts_.backend, a);
  }
  /// What a row of a rule makes of the step in arrays().increment.
  void set_end(Field out, StepRule::Row const& row) { set_row(out, row, 1); }

  static Scaled<T, dim> scaled(double factor, ConstField field) { return {factor, field}; }
  static Scaled<T, dim> scaled(double factor, Field field) { return {factor, {field.data}}; }

 private:
  /// That of M in the matrix, 1/s².
  double inertia_factor(StepRule const& rule) const {
    return rule.inertia_weight * rule.acceleration.d +
           parts_.state.damping * rule.force_weight * rule.velocity.d;
  }
  /// out = weight · row + (1 − weight) · what it was: the velocity or the acceleration.
  void set_row(Field out, StepRule::Row const& row, double weight) {
    auto& own = arrays();
    auto& kept = parts_.state.implicit;
    bool const of_speed = out.data == own.speed.data();
    double const stays = 1 - weight;
    set_sum(parts_.backend, nodes_, out, scaled(weight * row.d, field(own.increment)),
            scaled(weight * row.v + (of_speed ? stays : 0), parts_.v()),
            scaled(weight * row.a + (of_speed ? 0 : stays), field(kept.a)),
            scaled(weight * row.d_before, field(kept.d_before)),
            scaled(weight * row.v_before, field(kept.v_before)));
  }
  /// residual = force + loads − M (w − g); w and force are complete.
  Size sum_up(Field w) {
    auto& own = arrays();
    auto const inert = field(own.inert), r = field(own.residual);
    parts_.backend.for_each(nodes_, TakeAway<T, dim>{w, external_forces(parts_).gravity});
    parts_.layout.interpolation.apply(parts_.backend, w);
    clear_rows(parts_, inert);
    add_mass_product(parts_, mass_, -1, {w.data}, inert);
    parts_.layout.interpolation.apply_transpose(parts_.backend, inert);
    ConstField const load{external_forces(parts_).load};
    set_sum(parts_.backend, nodes_, r, scaled(1, field(own.force)), scaled(1, inert),
            scaled(load.data ? 1 : 0, load));
    keep_unknowns(parts_, r);
    return {norm(own.residual), std::max({weight_, norm(own.force), norm(own.inert)})};
  }
  Parts& parts_;
  MassMatrix mass_;
  double stiffness_damping_;
  Index nodes_;
  double weight_ = 0;
};

}  // namespace pliant::detail

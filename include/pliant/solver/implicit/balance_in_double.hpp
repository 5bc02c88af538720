#pragma once

#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/implicit/scheme.hpp>
#include <pliant/solver/refine_in_double.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant::detail {

/// The residual of implicit steps (see Balance) on the host in double precision, of a body that is in single.
template <DeformableBody TheBody>
class BalanceInDouble {
  static constexpr int dim = TheBody::dim;
  using Problem = StaticProblem<TheBody>;
  using Vector = Eigen::VectorXd;

 public:
  BalanceInDouble(TheBody const& body, MassMatrix mass, double stiffness_damping)
      : body_(body),
        problem_(body, mass),
        mass_(by_scalars(mass_blocks(body, mass))),
        stiffness_damping_(stiffness_damping) {}

  /// Steps d by a rule from the body's present state, for laws that see a step dt, s.
  void begin(StepRule const& rule, double dt) {
    rule_ = rule;
    dt_ = dt;
    auto const& state = body_.state();
    u_ = flat(state.u);
    v_ = flat(state.v);
    a_ = flat(state.implicit.a);
    d_before_ = flat(state.implicit.d_before);
    v_before_ = flat(state.implicit.v_before);
    if (stiffness_damping_ != 0)
      damping_ = assembled_at(body_.parts(), u_, Assemble::stiffness, dt, 1).stiffness;
  }
  DoubleResidual operator()(Vector const& d) const {
    double const wf = rule_.force_weight, wm = rule_.inertia_weight;
    Vector const v = wf * row(rule_.velocity, d) + (1 - wf) * v_,
                 a = wm * row(rule_.acceleration, d) + (1 - wm) * a_;
    Vector const force =
        assembled_at(body_.parts(), u_ + wf * d, Assemble::energy_and_force, dt_, 1).force;
    Vector const inert = mass_ * (a + body_.state().damping * v);
    Vector r = force + problem_.external - inert;
    if (stiffness_damping_ != 0) r -= stiffness_damping_ * (damping_ * v);
    problem_.unknowns.keep(r);
    return {r, std::max({problem_.external.norm(), force.norm(), inert.norm()})};
  }
  /// Adds to unknowns, and has slaves follow.
  void add(Vector& d, Vector const& change) const { problem_.add(d, change, 1); }
  template <class Array>
  Vector flat(Array const& array) const {
    if (array.size() == 0) return Vector::Zero(problem_.size());
    return Problem::flat(body_.parts().layout.in_user_order(array));
  }
  auto padded(Vector const& values) const {
    return body_.parts().layout.padded(Problem::per_node(values));
  }

 private:
  Vector row(StepRule::Row const& row, Vector const& d) const {
    return row.d * d + row.v * v_ + row.a * a_ + row.d_before * d_before_ +
           row.v_before * v_before_;
  }

  TheBody const& body_;
  Problem problem_;
  Eigen::SparseMatrix<double> mass_, damping_;
  double stiffness_damping_, dt_ = 0;
  StepRule rule_{};
  Vector u_, v_, a_, d_before_, v_before_;
};

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include <pliant/solver/implicit/assembled_steps.hpp>
#include <pliant/solver/implicit/balance.hpp>
#include <pliant/solver/implicit/balance_in_double.hpp>
#include <pliant/solver/implicit/options.hpp>
#include <pliant/solver/least_jacobian_on.hpp>

namespace pliant::detail {

/// Of ImplicitOptions::tolerance, unset.
inline constexpr double usual_implicit_tolerance = 1e-10;

/// Why an implicit step was not taken.
struct StepNotTaken {
  std::string message;
};

/// Solves the equations of implicit steps by Newton's method.
template <ImplicitScheme Scheme, DeformableBody TheBody>
class StepSolver {
  static constexpr int dim = TheBody::dim;
  using Parts = typename TheBody::parts_type;
  using T = typename Parts::T;
  using Field = typename Parts::Field;

 public:
  /// `report` counts iterations. Throws Error where the linear method that is asked for does not serve.
  StepSolver(TheBody& body, ImplicitOptions const& options, LinearSolver<dim>& linear,
             ImplicitReport& report)
      : options_(options),
        body_(body),
        parts_(body.parts()),
        balance_(parts_, options_.mass, options_.stiffness_damping),
        linear_(linear),
        before_(linear.report()),
        preconditioning_(options_.preconditioner),
        report_(report),
        tolerance_(options_.tolerance.value_or(usual_implicit_tolerance)) {
    bool const conservative = is_conservative(body);
    bool const on_host = std::same_as<typename Parts::backend_type::Recording, HostRecording>;
    if (options_.linear == LinearMethod::matrix_free && !conservative)
      throw Error(Scheme::name,
                  ": pressures that follow a surface have no symmetric tangent, which conjugate "
                  "gradients ask for; take LinearMethod::automatic");
    bool const matrix_free =
        options_.linear == LinearMethod::matrix_free ||
        (options_.linear == LinearMethod::automatic && !on_host && conservative);
    if (!matrix_free) assembled_.emplace(body, options_.mass, linear_);
    may_assemble_ = matrix_free && options_.linear == LinearMethod::automatic;
  }

  /// Solves for the step of size h, in arrays.increment: by full steps of Newton's method, and where these do not
  /// converge by steps of searched length.
  void take(StepRule const& rule, double h) {
    auto const& state = parts_.state;
    rule_ = rule;
    ask_motions(parts_, state.time + h, h);
    set_step_size(parts_, rule_.force_weight * h);
    linear_.begin_anew();
    preconditioning_.begin_anew();
    why_not_.clear();
    bool converged = iterate(h, false) || iterate(h, true);
    if (!converged && may_assemble_) {
      // Directions of negative curvature end conjugate gradients; a factorisation goes through them.
      why_not_.clear();
      assembled_.emplace(body_, options_.mass, linear_);
      converged = iterate(h, false) || iterate(h, true);
      assembled_.reset();  // the next step begins as one of another call would
    }
    if (!converged && !why_not_.empty()) throw StepNotTaken{why_not_};
    if (!converged)
      throw StepNotTaken{
          message({Scheme::name, ": no convergence in the step to time ", state.time + h,
                   " s after ", options_.max_iterations, " iterations, residual ", report_.residual,
                   " N; take smaller steps, or a law that does not soften"})};
    look_for_folds(h);
  }
  /// The change of the step by Newton's method, into arrays.solution. False where there is none.
  bool solve(double tolerance, double h) {
    auto& own = balance_.arrays();
    auto const matrix = balance_.matrix(rule_);
    auto const r = balance_.field(own.residual), kept = balance_.field(own.trial);
    set_sum(parts_.backend, parts_.layout.rows, kept, balance_.scaled(1, r));
    if (assembled_) {
      try {
        assembled_->solve(own, matrix, rule_.force_weight * h, tolerance);
      } catch (Error const& error) {
        why_not_ = error.what();
        return false;
      }
    } else {
      auto const found =
          solve_matrix_free(parts_, own, matrix, tolerance, options_.max_linear_iterations,
                            preconditioning_, options_.krylov);
      // Along a direction of negative curvature the iteration stops where it is: still a way down.
      if (found.iterations == 0 && found.indefinite) {
        why_not_ = message({Scheme::name,
                            ": the tangent is not positive definite; take smaller steps, "
                            "KrylovMethod::minres or LinearMethod::direct"});
        return false;
      }
    }
    start_work_ = parts_.backend.sum(parts_.layout.rows,
                                     DotAt<T, dim>{{own.solution.data()}, {own.trial.data()}});
    return true;
  }
  /// What linear systems took, into the report.
  void finish() {
    report_.linear = linear_.report();
    report_.linear.iterations -= before_.iterations;
    report_.linear.hierarchies -= before_.hierarchies;
    report_.factorisations = report_.linear.factorisations -= before_.factorisations;
    if (!assembled_) {
      report_.linear = preconditioning_.report();
      report_.linear.method = LinearMethod::matrix_free;
    }
  }

  Balance<Parts>& balance() { return balance_; }
  /// Of the step that was taken last: its rule, the residual over the forces, and the least det F.
  StepRule const& rule() const { return rule_; }
  double reached() const { return reached_; }
  LeastJacobian const& least() const { return least_; }

 private:
  using Size = typename Balance<Parts>::Size;

  /// Newton's method. Whether it converged.
  bool iterate(double h, bool searching) {
    auto& own = balance_.arrays();
    Size now = begin_iteration(h, searching);
    double const eps = 45 * double{std::numeric_limits<T>::epsilon()};
    double const size = norm_of(parts_.backend, parts_.layout.rows, parts_.u()) +
                        h * norm_of(parts_.backend, parts_.layout.rows, parts_.v());
    constexpr double nothing = 1e6 * double{std::numeric_limits<T>::min()};  // N: without digits
    double forcing = 1e-3;
    bool settled = false;
    for (int iteration = 0;; ++iteration) {
      report_.residual = now.residual;
      if (!std::isfinite(now.residual)) return false;
      // Where forces cancel to rounding, the displacement tells.
      if (now.residual <= std::max(tolerance_ * now.scale, nothing) || settled) {
        reached_ = now.scale > 0 ? now.residual / now.scale : 0;
        bool const enough = sizeof(T) == sizeof(double) || !options_.tolerance ||
                            now.residual <= nothing || reached_ <= tolerance_;
        if (!enough) return refine(h);
        balance_.balance_translations(rule_);
        return true;
      }
      if (iteration == options_.max_iterations) return false;
      double const enough = std::clamp(0.1 * tolerance_ * now.scale / now.residual, 1e-12, 0.1);
      double const before = now.residual;
      if (!solve(std::max(forcing, enough), h)) return false;
      ++report_.iterations;
      settled = balance_.norm(own.solution) <= eps * (size + balance_.norm(own.increment));
      now = go(searching && !settled);
      // Eisenstat and Walker, SIAM Journal on Scientific Computing 17 (1996) 16, their second choice.
      forcing = std::clamp(0.9 * square(now.residual / before), 1e-6, 1e-3);
    }
  }
  /// The step in single precision, refined by residuals in double. Whether that goes.
  bool refine(double h) {
    auto& own = balance_.arrays();
    if (!in_double_) in_double_.emplace(body_, options_.mass, options_.stiffness_damping);
    in_double_->begin(rule_, rule_.force_weight * h);
    Eigen::VectorXd d = in_double_->flat(own.increment);
    bool solved = true;
    auto const correct = [&](Eigen::VectorXd const& residual, double gain, Eigen::VectorXd& to) {
      own.residual.upload(in_double_->padded(residual));
      solved = solved && solve(gain, h);
      if (solved) in_double_->add(to, in_double_->flat(own.solution));
      ++report_.corrections;
    };
    auto const left = refine_in_double(d, tolerance_, *in_double_, correct);
    if (left.empty() || !solved) return false;
    own.increment.upload(in_double_->padded(d));
    report_.residual = left.back().residual;
    reached_ = left.back().residual / left.back().scale;
    return true;
  }
  /// The better of two guesses of the step: along the present motion, and none.
  Size begin_iteration(double h, bool searching) {
    guess(h, !searching);
    Size const along = balance_.evaluate(rule_);
    if (searching || std::isfinite(along.residual)) return along;
    guess(h, false);
    return balance_.evaluate(rule_);
  }
  /// Adds the solution to the step: all of it, a smaller part where forces are not finite behind it, and, while
  /// searching, the part behind which the residual does little work along it (Matthies and Strang, International
  /// Journal for Numerical Methods in Engineering 14 (1979) 1613).
  Size go(bool searching) {
    auto& own = balance_.arrays();
    auto const d = balance_.field(own.increment), along = balance_.field(own.solution);
    Index const n = parts_.layout.rows;
    auto const work = [&] {
      return parts_.backend.sum(n, DotAt<T, dim>{{along.data}, {own.residual.data()}});
    };
    double const at_start = searching ? start_work_ : 0;
    double share = 0, next = searching && at_start < 0 ? -1 : 1;
    for (int trial = 0;; ++trial) {
      set_sum(parts_.backend, n, d, balance_.scaled(1, d), balance_.scaled(next - share, along));
      share = next;
      Size const now = balance_.evaluate(rule_);
      bool const finite = std::isfinite(now.residual);
      if (trial == 10) return now;
      if (finite && !searching) return now;
      double const left = finite ? work() : 0;
      if (finite && std::abs(left) <= 0.8 * std::abs(at_start)) return now;
      double const secant = finite ? at_start / (at_start - left) : 0;
      next = share * (secant > 0.1 && secant < 0.7 ? secant : finite ? 0.5 : 0.25);
    }
  }
  /// The step as far as it is known before: along the present motion, or none, with driven nodes where they are to be.
  void guess(double h, bool along) {
    auto& own = balance_.arrays();
    auto const d = balance_.field(own.increment), place = balance_.field(own.place);
    Index const n = parts_.layout.rows;
    bool const bends = along && Scheme::order > 1;
    set_sum(parts_.backend, n, d, balance_.scaled(along ? h : 0, parts_.v()),
            balance_.scaled(bends ? h * h / 2 : 0, balance_.field(parts_.state.implicit.a)));
    set_sum(parts_.backend, n, place, balance_.scaled(1, parts_.u()));
    for (auto const& driven : parts_.driven)
      driven.place(parts_.backend, place, balance_.field(own.trial));
    set_sum(parts_.backend, n, place, balance_.scaled(1, place), balance_.scaled(-1, parts_.u()));
    parts_.backend.for_each(n, TakeHeld<T, dim>{d, {place.data}, parts_.layout.held.data()});
    parts_.layout.interpolation.apply(parts_.backend, d);
  }
  void look_for_folds(double h) {
    auto& own = balance_.arrays();
    auto const end = balance_.field(own.trial);
    set_sum(parts_.backend, parts_.layout.rows, end, balance_.scaled(1, parts_.u()),
            balance_.scaled(1, balance_.field(own.increment)));
    least_ = least_jacobian_on(parts_, {end.data}, true);
    if (least_.value > 0 || options_.accept_folded) return;
    auto const folded = least_jacobian_on(parts_, {end.data}, false);
    if (folded.value > 0) return;
    throw StepNotTaken{
        message({Scheme::name, ": the step to time ", parts_.state.time + h,
                 " s folds the body: det F comes to ", folded.value, " in ", folded.element,
                 " element ", folded.number,
                 ", perhaps between the points of its quadrature; take smaller steps, more "
                 "points or a finer mesh there, or accept it by accept_folded"})};
  }

  ImplicitOptions const& options_;
  TheBody& body_;
  Parts& parts_;
  Balance<Parts> balance_;
  LinearSolver<dim>& linear_;
  LinearReport before_;
  Preconditioning<Parts> preconditioning_;
  ImplicitReport& report_;
  double tolerance_;
  std::optional<BalanceInDouble<TheBody>> in_double_;
  std::optional<AssembledSteps<TheBody>> assembled_;
  bool may_assemble_ = false;  // where steps without a matrix find no way
  StepRule rule_{};
  LeastJacobian least_{};
  std::string why_not_;    // the linear system of a step was not solved; empty where it was
  double reached_ = 0;     // of the present step
  double start_work_ = 0;  // J: of the residual along the solution, where that begins
};

}  // namespace pliant::detail

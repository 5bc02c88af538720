#pragma once

#include <cmath>
#include <limits>

#include <pliant/solver/least_jacobian.hpp>
#include <pliant/solver/linear/linear_solver.hpp>
#include <pliant/solver/linear/same_registers.hpp>
#include <pliant/solver/load_steps.hpp>
#include <pliant/solver/static_on_backend.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant {

namespace detail {

inline void check_options(NewtonOptions const& options) {
  if (options.load_steps < 1 || options.max_iterations < 1 || options.max_linear_iterations < 1)
    throw Error("solve_static: load_steps ", options.load_steps, ", max_iterations ",
                options.max_iterations, " and max_linear_iterations ",
                options.max_linear_iterations, "; give 1 or more");
  if (options.load_halvings < 0 || options.load_halvings > 30)
    throw Error("solve_static: load_halvings ", options.load_halvings, "; give 0 to 30");
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw Error("solve_static: a tolerance of ", options.tolerance,
                "; give a number between 0 and 1, relative to the forces");
}

/// Newton's method on one body: see solve_static.
template <DeformableBody TheBody>
class StaticNewton {
 public:
  using Vector = Eigen::VectorXd;

  StaticNewton(TheBody const& body, NewtonOptions const& options)
      : body_(body),
        options_(options),
        tasks_(body.parts().backend),
        problem_(body, options.gravity),
        conservative_(is_conservative(body)),
        linear_("solve_static", options.linear),
        u_(StaticProblem<TheBody>::flat(
            body.parts().layout.in_user_order(place_before_drives(body.parts())))) {
    report_.unknowns = problem_.unknowns.count();
    report_.gravity = options.gravity;
  }

  /// The displacement in equilibrium.
  Vector const& solve() {
    Vector const from = u_;
    Vector to = u_;
    problem_.prescribe(to, body_.time());
    Vector balance, reached = u_;
    auto const take = [&](LoadStep const& step) {
      step_ = step;
      if (step.to == 1) {
        load_ = problem_.external;
        target_ = to;
      } else {
        if (balance.size() == 0) {  // what is in balance where the body is: loads grow from there
          step_.to = 0;
          balance = evaluate(from).force;
          problem_.unknowns.keep(balance);
          step_ = step;
        }
        load_ = step.to * problem_.external - (1 - step.to) * balance;
        target_ = from + step.to * (to - from);
      }
      iterate();
      if (step.to == 1) refuse_folds(options_, least_jacobian_at(body_.parts(), u_, false));
      reached = u_;
    };
    report_.load_steps = follow_loads(options_, take, [&] {
      u_ = reached;
      linear_.begin_anew();
    });
    report_.indefinite =
        conservative_ && options_.tangents == ElementTangents::exact && linear_.indefinite();
    report_.linear = linear_.report();
    report_.factorisations = report_.linear.factorisations;
    report_.least_J = least_jacobian_at(body_.parts(), u_, true);
    return u_;
  }
  NewtonReport const& report() const { return report_; }

 private:
  struct Evaluated {
    double energy;  // J
    Vector force;   // N
  };
  void assemble_at(Vector const& u, Assemble what) {
    assemble_into(sum_, body_.parts(), u, what, std::numeric_limits<double>::infinity(), step_.to,
                  options_.tangents);
  }
  Evaluated evaluate(Vector const& u) {
    assemble_at(u, Assemble::energy_and_force);
    return {sum_.energy, sum_.force};
  }
  /// Over the unknowns.
  Vector out_of_balance(Evaluated const& now) const {
    Vector r = now.force + load_;
    problem_.unknowns.keep(r);
    return r;
  }
  bool is_unfolded(Vector const& u) const {
    return least_jacobian_at(body_.parts(), u, false).value > 0;
  }
  /// One load step.
  void iterate() {
    auto now = evaluate(u_);
    bool settled = false;
    double forcing = first_forcing;
    bool linear_so_far = false;  // forces changed as the present stiffness says
    for (int iteration = 0;; ++iteration) {
      Vector const increment = target_ - u_;  // of driven nodes, with their slaves
      bool const driving = is_driven_by(increment);
      Vector const residual = out_of_balance(now);
      double const scale = std::max(load_.norm(), now.force.norm());
      report_.residual = residual.norm();
      if (iteration == 0) report_.residuals.clear();
      report_.residuals.push_back(report_.residual);
      report_.energy = now.energy;
      bool const finite = std::isfinite(report_.residual) && std::isfinite(now.energy);
      if (!driving && finite && (settled || report_.residual <= options_.tolerance * scale)) return;
      if (!finite && iteration == 0) throw Error(folded_start());
      if (iteration == options_.max_iterations || !finite)
        throw LoadStepFailed(no_convergence(step_, iteration, report_.residual));
      if (!linear_so_far) {
        assemble_at(u_, Assemble::stiffness);
        ++report_.assemblies;
      }
      Vector pull = residual, prescribed = Vector::Zero(problem_.size());
      if (driving) {
        problem_.copy_prescribed(increment, prescribed);
        Vector pushed;
        multiply(tasks_, sum_.stiffness, prescribed, pushed);
        pull -= pushed;
        problem_.unknowns.keep(pull);
      }
      // Nothing but folds bounds a step that moves driven nodes: it has to be right.
      double const enough = std::max(driving ? driving_forcing : forcing,
                                     0.1 * options_.tolerance * scale / pull.norm());
      Vector const du = solve_linear(pull, std::min(enough, 0.1), iteration);
      double const factor = search(now, residual, du, prescribed, driving);
      largest_ = std::max(largest_, u_.norm());
      settled = factor == 1 && !driving && du.norm() <= 1e-14 * largest_;
      double const shrunk = out_of_balance(now).norm() / pull.norm();
      double const surprise = std::abs(shrunk - linear_.reached());
      forcing = std::clamp(surprise, 0.0, first_forcing);
      linear_so_far = factor == 1 && surprise < 1e-9;
      ++report_.iterations;
    }
  }
  /// Only the first matrix of a load step stays the same in a shorter one.
  Vector solve_linear(Vector const& pull, double tolerance, int iteration) {
    try {
      return linear_.solve(tasks_,
                           {sum_.stiffness, problem_.unknowns, body_.mesh().nodes, conservative_},
                           pull, tolerance);
    } catch (Error const& error) {
      if (iteration == 0) throw;
      throw LoadStepFailed(error.what());
    }
  }
  bool is_driven_by(Vector const& increment) const {
    Vector prescribed = Vector::Zero(problem_.size());
    problem_.copy_prescribed(increment, prescribed);
    return (prescribed.array() != 0).any();
  }
  /// Goes along a step as far as it leads down: on the potential energy, or on the work of the residual
  /// along the step where there is none. A step that moves driven nodes has neither to compare with: it
  /// goes as far as nothing folds. Returns the share of it taken; `now` is then of the new u.
  double search(Evaluated& now, Vector const& residual, Vector const& du, Vector const& prescribed,
                bool driving) {
    double const potential = now.energy - load_.dot(u_);
    bool const unfolded = driving && is_unfolded(u_);
    for (int halving = 0;; ++halving) {
      double const factor = std::ldexp(1.0, -halving);
      Vector trial = u_ + factor * prescribed;
      if (factor == 1) problem_.copy_prescribed(target_, trial);
      problem_.add(trial, du, factor);
      auto next = evaluate(trial);
      Vector const left = out_of_balance(next);
      bool const finite = left.allFinite() && std::isfinite(next.energy);
      bool better = false;
      if (driving)
        better = !unfolded || is_unfolded(trial);
      else if (conservative_)
        better = next.energy - load_.dot(trial) <= potential || left.norm() < residual.norm();
      else
        better =
            std::abs(du.dot(left)) < std::abs(du.dot(residual)) || left.norm() < residual.norm();
      if (halving < 20 && !(finite && better)) continue;
      u_ = std::move(trial);
      now = std::move(next);
      return factor;
    }
  }

  TheBody const& body_;
  /// Of the residual, for linear systems as long as Newton's method is far from the answer.
  static constexpr double first_forcing = 1e-3, driving_forcing = 1e-6;

  NewtonOptions options_;
  HostTasks tasks_;
  StaticProblem<TheBody> problem_;
  bool conservative_;
  LinearSolver<TheBody::dim> linear_;
  AssembledBlocks<TheBody::dim> sum_;
  Vector u_, load_, target_;
  double largest_ = 0;  // m: of all displacements so far
  LoadStep step_;
  NewtonReport report_;
};

}  // namespace detail

/// Brings a body into static equilibrium with its gravity, loads and conditions: Newton's method on
/// the assembled matrix, in double precision whatever the body's own, or without a matrix where the body's arrays lie
/// (NewtonOptions::linear), with load steps and a line search: on the potential energy, or, as pressures that follow a
/// surface have none, on the work of the residual along the step (Matthies and Strang, International Journal for Numerical Methods in
/// Engineering 14 (1979) 1613). The first linear solve of a load step carries its increment of driven
/// nodes. Load steps lead from where the body is, in balance with what it then bears, to all of its
/// loads, and are halved where they fail; the user's own force terms act in full. Done within the tolerance, or when a step no longer
/// moves anything but the last digits. Internal variables are brought to rest. Velocities are left alone. Throws
/// Error, with the body as it was, where the matrix is singular, the iteration does not converge in the shortest load steps, or the
/// answer is folded (det F ≤ 0, looked for all over each element whose law is not linear).
template <DeformableBody TheBody>
NewtonReport solve_static(TheBody& body, NewtonOptions const& options = {}) {
  detail::check_registers();
  detail::check_options(options);
  NewtonReport report;
  bool solved = false;
  if (options.linear == LinearMethod::matrix_free) {
    report = detail::solve_static_matrix_free(body, options);
    solved = true;
  } else if (options.linear == LinearMethod::automatic &&
             options.tangents == ElementTangents::exact && detail::lies_better_on_backend(body)) {
    try {
      report = detail::solve_static_matrix_free(body, options);
      solved = true;
    } catch (Error const&) {  // factors can do more; nothing has changed
    }
  }
  if (!solved) {
    detail::StaticNewton<TheBody> newton(body, options);
    body.set_displacements(detail::StaticProblem<TheBody>::per_node(newton.solve()));
    report = newton.report();
  }
  body.parts().before_drives = {};
  if constexpr (TheBody::has_internal_variables)
    change_by_hand(body.parts(), [&] { equilibrate(body.parts()); });
  return report;
}

}  // namespace pliant

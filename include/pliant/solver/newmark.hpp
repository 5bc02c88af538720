#pragma once

#include <memory>

#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/linear/direct_solver.hpp>
#include <pliant/solver/newton.hpp>

namespace pliant {

/// How Newmark steps: u' and v' are in its docstring.
struct NewmarkOptions {
  double step = 0;  // s, positive and finite
  /// The trapezoidal rule: second order, unconditionally stable and without damping for small motions. In
  /// large ones its energy may grow: watch it, or take γ > 1/2 with β = (γ + 1/2)²/4.
  double beta = 0.25, gamma = 0.5;  // β in (0, 1], γ in [1/2, 1]
  MassMatrix mass = MassMatrix::consistent;
  int max_iterations = 30;   // of Newton's method, per step
  double tolerance = 1e-10;  // of the residual, relative to the largest of the forces; below 1
};

/// Implicit time integration on the assembled matrix, in double precision (Newmark 1959):
/// u' = u + Δt v + Δt² ((1/2 − β) a + β a'), v' = v + Δt ((1 − γ) a + γ a'), with the accelerations in
/// balance with the forces at both ends: M a = F(u) + loads − c M v. Gravity acts on the same masses. For
/// steps longer than the explicit ones, on bodies small enough for a direct solver.
class Newmark {
 public:
  /// Throws Error for options that cannot work: see NewmarkOptions.
  explicit Newmark(NewmarkOptions const& options) : options_(options) {
    if (!(options.step > 0 && std::isfinite(options.step)))
      throw Error("Newmark: step ", options.step, " s; give a positive, finite step");
    if (!(options.beta > 0 && options.beta <= 1) || !(options.gamma >= 0.5 && options.gamma <= 1))
      throw Error("Newmark: beta ", options.beta, " and gamma ", options.gamma,
                  "; give beta above 0 up to 1, and gamma from 1/2 to 1");
    if (options.max_iterations < 1)
      throw Error("Newmark: max_iterations ", options.max_iterations, "; give 1 or more");
    if (!(options.tolerance > 0 && options.tolerance < 1))
      throw Error("Newmark: a tolerance of ", options.tolerance,
                  "; give a number between 0 and 1, relative to the forces");
  }

  /// Takes steps; driven nodes have the speed of their motions over a step. Throws Error where one does not
  /// converge; the body is then exactly as the last one that did left it.
  template <DeformableBody TheBody>
  void operator()(TheBody& body, int steps = 1) {
    static_assert(!TheBody::has_internal_variables,
                  "Newmark takes laws without internal variables: step viscous bodies with "
                  "CentralDifference");
    if (steps < 0) throw Error("Newmark: ", steps, " steps; give 0 or more");
    if (steps == 0) return;
    using Problem = detail::StaticProblem<TheBody>;
    System<TheBody> const system(body, options_.mass);
    State now{system.problem.start(), Problem::flat(body.velocities()), {}};
    // Velocities of driven nodes, which a body does not keep, and digits beyond its precision go on.
    bool const goes_on = taken_ != nullptr && body.parts().integrator == taken_ &&
                         revision_ == body.parts().revision && now.u.size() == seen_.u.size() &&
                         now.u == seen_.u && now.v == seen_.v;
    if (goes_on)
      now = last_;
    else
      take_speed_of_motions(system.problem, now, body.time());
    if (!goes_on || system.problem.external != external_) now.a = acceleration(system, now);
    external_ = system.problem.external;
    double time = body.time();
    int done = 0;
    try {
      for (; done < steps; ++done) {
        now = next(system, now, time + options_.step);
        time += options_.step;
      }
    } catch (...) {
      if (done > 0) store(body, now, time, done);
      throw;
    }
    store(body, now, time, done);
  }

 private:
  struct State {
    Eigen::VectorXd u, v, a;
  };

  /// The body as matrices and vectors over (node, direction).
  template <DeformableBody TheBody>
  struct System {
    TheBody const& body;
    detail::StaticProblem<TheBody> problem;
    Eigen::SparseMatrix<double> mass;
    bool conservative;

    System(TheBody const& b, MassMatrix kind)
        : body(b),
          problem(b, kind),
          mass(assemble_mass(b, kind)),
          conservative(detail::is_conservative(b)) {}
  };

  /// Gives driven nodes the mean velocity of their motions over the step before a time, s, or over the first one
  /// where none was before.
  template <class Problem>
  void take_speed_of_motions(Problem const& problem, State& s, double time) const {
    double const start = time >= options_.step ? time - options_.step : time;
    Eigen::VectorXd from = s.u, to = s.u;
    problem.prescribe(from, start);
    problem.prescribe(to, start + options_.step);
    problem.copy_prescribed((to - from) / options_.step, s.v);
  }

  /// In balance with the forces at u and v; zero where nodes are held or driven.
  template <DeformableBody TheBody>
  Eigen::VectorXd acceleration(System<TheBody> const& system, State const& s) {
    auto const force = assemble(system.body, s.u, Assemble::energy_and_force).force;
    Eigen::VectorXd const pull =
        force + system.problem.external - system.body.state().damping * (system.mass * s.v);
    Eigen::VectorXd a = Eigen::VectorXd::Zero(s.u.size());
    auto const& unknowns = system.problem.unknowns;
    system.problem.add(a,
                       unknowns.expand(by_mass_.solve(unknowns.restrict(system.mass),
                                                      unknowns.restrict(pull), true)),
                       1);
    return a;
  }

  /// The state at a time, one step on.
  template <DeformableBody TheBody>
  State next(System<TheBody> const& system, State const& now, double time) {
    double const dt = options_.step, beta = options_.beta, gamma = options_.gamma;
    double const damping = system.body.state().damping;
    double const a_by_u = 1 / (beta * dt * dt), v_by_u = gamma / (beta * dt);
    auto const& external = system.problem.external;
    Eigen::VectorXd const coast = now.u + dt * now.v + dt * dt * (0.5 - beta) * now.a;
    Eigen::VectorXd const coasting = now.v + dt * (1 - gamma) * now.a;
    auto const& unknowns = system.problem.unknowns;
    Eigen::SparseMatrix<double> const inertia =
        unknowns.restrict(system.mass) * (a_by_u + damping * v_by_u);

    State then;
    then.u = now.u;  // held where it is
    system.problem.add(then.u, dt * now.v + dt * dt / 2 * now.a, 1);
    system.problem.prescribe(then.u, time);
    double last_change = std::numeric_limits<double>::infinity();
    for (int iteration = 0;; ++iteration) {
      then.a = a_by_u * (then.u - coast);
      then.v = coasting + gamma * dt * then.a;
      auto const state = assemble(system.body, then.u);
      Eigen::VectorXd const pull = state.force + external;
      Eigen::VectorXd const inert = system.mass * (then.a + damping * then.v);
      Eigen::VectorXd const residual = unknowns.restrict(Eigen::VectorXd(pull - inert));
      double const scale = std::max({external.norm(), state.force.norm(), inert.norm()});
      double const size = residual.norm();
      // Where forces cancel to rounding, the displacement tells.
      bool const settled = last_change <= 1e-14 * (then.u.norm() + dt * then.v.norm());
      if (std::isfinite(size) && (size <= options_.tolerance * scale || settled)) return then;
      if (iteration == options_.max_iterations || !std::isfinite(size))
        throw Error("Newmark: no convergence in the step to time ", time, " s after ", iteration,
                    " iterations, residual ", size,
                    " N; take smaller steps, or a law that does not soften");
      Eigen::SparseMatrix<double> const matrix = unknowns.restrict(state.stiffness) + inertia;
      Eigen::VectorXd const du = direct_.solve(matrix, residual, system.conservative);
      system.problem.add(then.u, unknowns.expand(du), 1);
      last_change = du.norm();
    }
  }

  template <DeformableBody TheBody>
  void store(TheBody& body, State const& state, double time, int steps) {
    using Problem = detail::StaticProblem<TheBody>;
    auto const u = Problem::per_node(state.u), v = Problem::per_node(state.v);
    detail::check_field<typename TheBody::scalar>("Newmark (velocities)", v, body.nodes());
    body.set_displacements(u);
    body.set_velocities(v);
    body.parts().state.time = time;
    body.parts().state.steps += steps;
    body.parts().integrator = taken_ = std::make_shared<char>();
    revision_ = body.parts().revision;
    last_ = state;
    seen_ = {Problem::flat(body.displacements()), Problem::flat(body.velocities()), {}};
  }

  NewmarkOptions options_;
  detail::DirectSolver direct_{"Newmark"}, by_mass_{"Newmark"};
  std::shared_ptr<void const> taken_;  // tells the body as it was left from all others
  long revision_ = 0;
  Eigen::VectorXd external_;  // of last_
  State last_, seen_;         // as it was left, and as the body has it
};

}  // namespace pliant

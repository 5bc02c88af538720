#pragma once

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
  int max_iterations = 30;     // of Newton's method, per step
  double tolerance = 1e-10;    // of the residual, relative to the largest of the forces; below 1
  bool accept_folded = false;  // steps that fold the body somewhere, instead of an Error
};

/// What a call of Newmark did, and at what cost.
struct NewmarkReport {
  int steps = 0;           // taken
  double time = 0;         // s: where the body is now
  int iterations = 0;      // of Newton's method, in all
  int factorisations = 0;  // of matrices, in all
  double residual = 0;     // N, of the last step
  LeastJacobian
      least_J{};  // det F where it is least at the ends of these steps, at points of elements and between
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

  /// Takes steps; driven nodes have the speed of their motions over a step. What it needs from call to call stands
  /// in the body's state: a body that is saved, copied or rolled back goes on with the same bits, by this
  /// Newmark or another. Throws Error where a step does not converge or folds the body (det F ≤ 0, looked
  /// for all over each element whose law is not linear); the body is then exactly as the last step that was good
  /// left it.
  template <DeformableBody TheBody>
  NewmarkReport operator()(TheBody& body, int steps = 1) {
    static_assert(!TheBody::has_internal_variables,
                  "Newmark takes laws without internal variables: step viscous bodies with "
                  "CentralDifference");
    if (steps < 0) throw Error("Newmark: ", steps, " steps; give 0 or more");
    NewmarkReport report{.time = body.time()};
    if (steps == 0) return report;
    int const before = direct_.factorisations() + by_mass_.factorisations();
    System<TheBody> const system(body, options_.mass);
    Motion now = present_motion(body, system);
    try {
      for (; report.steps < steps; ++report.steps) {
        Motion then = next(system, now, report.time + options_.step, report);
        look_for_folds(body, then, report);
        now = std::move(then);
        report.time += options_.step;
      }
    } catch (...) {
      if (report.steps > 0) store(body, system, now, report);
      throw;
    }
    store(body, system, now, report);
    report.factorisations = direct_.factorisations() + by_mass_.factorisations() - before;
    return report;
  }

 private:
  struct Motion {
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

  /// Where the body is, with accelerations in balance.
  template <DeformableBody TheBody>
  Motion present_motion(TheBody& body, System<TheBody> const& system) {
    auto const& kept = body.state().integrator.implicit;
    Motion now;
    bool balanced = false;
    if (kept.empty()) {
      now = {system.problem.start(), detail::StaticProblem<TheBody>::flat(body.velocities()), {}};
      take_speed_of_motions(system.problem, now, body.time());
    } else {
      now = {vector_of(kept.u), vector_of(kept.v), vector_of(kept.a)};
      balanced = !kept.a.empty() && system.problem.external == vector_of(kept.external) &&
                 kept.damping == body.state().damping &&
                 kept.mass == static_cast<std::int32_t>(options_.mass);
    }
    if (!balanced) now.a = acceleration(system, now);
    return now;
  }
  static Eigen::Map<Eigen::VectorXd const> vector_of(std::vector<double> const& values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
  }
  static std::vector<double> list_of(Eigen::VectorXd const& values) {
    return {values.data(), values.data() + values.size()};
  }

  /// Gives driven nodes the mean velocity of their motions over the step before a time, s, or over the first one
  /// where none was before.
  template <class Problem>
  void take_speed_of_motions(Problem const& problem, Motion& s, double time) const {
    double const start = time >= options_.step ? time - options_.step : time;
    Eigen::VectorXd from = s.u, to = s.u;
    problem.prescribe(from, start);
    problem.prescribe(to, start + options_.step);
    problem.copy_prescribed((to - from) / options_.step, s.v);
  }

  /// In balance with the forces at u and v; zero where nodes are held or driven.
  template <DeformableBody TheBody>
  Eigen::VectorXd acceleration(System<TheBody> const& system, Motion const& s) {
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

  /// The motion at a time, one step on.
  template <DeformableBody TheBody>
  Motion next(System<TheBody> const& system, Motion const& now, double time,
              NewmarkReport& report) {
    double const dt = options_.step, beta = options_.beta, gamma = options_.gamma;
    double const damping = system.body.state().damping;
    double const a_by_u = 1 / (beta * dt * dt), v_by_u = gamma / (beta * dt);
    auto const& external = system.problem.external;
    Eigen::VectorXd const coast = now.u + dt * now.v + dt * dt * (0.5 - beta) * now.a;
    Eigen::VectorXd const coasting = now.v + dt * (1 - gamma) * now.a;
    auto const& unknowns = system.problem.unknowns;
    Eigen::SparseMatrix<double> const inertia =
        unknowns.restrict(system.mass) * (a_by_u + damping * v_by_u);

    Motion then;
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
      double const size = report.residual = residual.norm();
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
      ++report.iterations;
    }
  }

  /// Throws Error where a step folds an element whose law takes no folds.
  template <DeformableBody TheBody>
  void look_for_folds(TheBody const& body, Motion const& then, NewmarkReport& report) const {
    auto const least = detail::least_jacobian_at(body.parts(), then.u, true);
    if (!(least.value > 0) && !options_.accept_folded) {
      auto const folded = detail::least_jacobian_at(body.parts(), then.u, false);
      if (!(folded.value > 0))
        throw Error("Newmark: the step to time ", report.time + options_.step,
                    " s folds the body: det F comes to ", folded.value, " in ", folded.element,
                    " element ", folded.number,
                    ", perhaps between the points of its quadrature; take smaller steps, more "
                    "points or a finer mesh there, or accept it by accept_folded");
    }
    if (!(least.value >= report.least_J.value)) report.least_J = least;
  }

  template <DeformableBody TheBody>
  void store(TheBody& body, System<TheBody> const& system, Motion const& motion,
             NewmarkReport const& report) {
    using Problem = detail::StaticProblem<TheBody>;
    auto const u = Problem::per_node(motion.u), v = Problem::per_node(motion.v);
    detail::check_field<typename TheBody::scalar>("Newmark (velocities)", v, body.nodes());
    body.set_displacements(u);
    body.set_velocities(v);
    auto& state = body.parts().state;
    state.time = report.time;
    state.steps += report.steps;
    state.integrator.active = false;  // explicit integrators begin anew
    state.integrator.implicit = {list_of(motion.u), list_of(motion.v),
                                 list_of(motion.a), list_of(system.problem.external),
                                 state.damping,     static_cast<std::int32_t>(options_.mass)};
    body.parts().integrator = nullptr;
  }

  NewmarkOptions options_;
  detail::DirectSolver direct_{"Newmark"}, by_mass_{"Newmark"};
};

}  // namespace pliant

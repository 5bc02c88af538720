#pragma once

#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/newton.hpp>

namespace pliant {

struct NewmarkOptions {
  double step = 0;  // s
  /// The trapezoidal rule: second order, unconditionally stable and without damping for small motions. In
  /// large ones its energy may grow: watch it, or take γ > 1/2 with β = (γ + 1/2)²/4.
  double beta = 0.25, gamma = 0.5;
  MassMatrix mass = MassMatrix::consistent;
  int max_iterations = 30;   // of Newton's method, per step
  double tolerance = 1e-10;  // of the residual, relative to the largest of the forces
};

/// Implicit time integration on the assembled matrix, in double precision (Newmark 1959):
/// u' = u + Δt v + Δt² ((1/2 − β) a + β a'), v' = v + Δt ((1 − γ) a + γ a'), with the accelerations in
/// balance with the forces at both ends: M a = F(u) + loads − c M v. Gravity acts on the same masses. For
/// steps longer than the explicit ones, on bodies small enough for a direct solver.
class Newmark {
 public:
  explicit Newmark(NewmarkOptions const& options) : options_(options) {
    if (!(options.step > 0 && std::isfinite(options.step)) || !(options.beta > 0) ||
        !(options.gamma >= 0.5) || options.max_iterations < 1 || !(options.tolerance > 0))
      throw Error(
          "Newmark: step, beta and tolerance must be positive, gamma at least 1/2, and "
          "max_iterations at least 1");
  }

  /// Takes steps. Throws Error where one does not converge; the body is then at the end of the last one
  /// that did.
  template <class TheBody>
  void operator()(TheBody& body, int steps = 1) {
    static_assert(!TheBody::has_internal_variables,
                  "Newmark takes laws without internal variables: step viscous bodies with "
                  "CentralDifference");
    System<TheBody> system(body, options_.mass);
    State now{system.problem.start(), vector_of(body.velocities()), {}};
    // Velocities of driven nodes, which a body does not keep, and digits beyond its precision go on.
    if (body_ == &body && revision_ == body.revision() && now.u == seen_.u && now.v == seen_.v)
      now = last_;
    else
      now.a = system.acceleration(now);
    for (int step = 0; step < steps; ++step) {
      body.tick(options_.step, 1);
      try {
        now = next(system, now);
      } catch (...) {
        body.tick(-options_.step, -1);
        store(body, now);
        throw;
      }
    }
    store(body, now);
  }

 private:
  struct State {
    Eigen::VectorXd u, v, a;
  };

  /// The body as matrices and vectors over (node, direction).
  template <class TheBody>
  struct System {
    static constexpr int dim = TheBody::dim;
    TheBody const& body;
    detail::StaticProblem<TheBody> problem;
    Eigen::SparseMatrix<double> mass;
    Eigen::VectorXd external;

    System(TheBody const& b, MassMatrix kind)
        : body(b), problem(b), mass(assemble_mass(b, kind)), external(problem.external) {
      // Gravity on these masses instead of lumped ones.
      Eigen::VectorXd gravity(external.size()), lumped(external.size());
      for (Index i = 0; i < body.nodes(); ++i)
        for (int k = 0; k < dim; ++k) {
          gravity[dim * i + k] = body.gravity()[static_cast<std::size_t>(k)];
          lumped[dim * i + k] = body.masses()[static_cast<std::size_t>(i)] * gravity[dim * i + k];
        }
      external += mass * gravity - lumped;
    }
    /// In balance with the forces at u and v; zero where nodes are held or driven.
    Eigen::VectorXd acceleration(State const& s) const {
      auto const force = assemble(body, s.u, Assemble::energy_and_force).force;
      Eigen::VectorXd const pull = force + external - body.damping() * (mass * s.v);
      Eigen::VectorXd a = Eigen::VectorXd::Zero(s.u.size());
      problem.add(a, detail::solve("Newmark", problem.restrict(mass), problem.restrict(pull), true),
                  1);
      return a;
    }
  };

  template <class TheBody>
  State next(System<TheBody> const& system, State const& now) const {
    double const dt = options_.step, beta = options_.beta, gamma = options_.gamma;
    double const damping = system.body.damping();
    double const a_by_u = 1 / (beta * dt * dt), v_by_u = gamma / (beta * dt);
    Eigen::VectorXd const coast = now.u + dt * now.v + dt * dt * (0.5 - beta) * now.a;
    Eigen::VectorXd const coasting = now.v + dt * (1 - gamma) * now.a;
    Eigen::SparseMatrix<double> const inertia =
        system.problem.restrict(system.mass) * (a_by_u + damping * v_by_u);

    State then;
    then.u = now.u;  // held where it is
    system.problem.add(
        then.u, system.problem.restrict(Eigen::VectorXd(dt * now.v + dt * dt / 2 * now.a)), 1);
    system.problem.prescribe(then.u, 1);
    interpolate_slaves(system.body, then.u);
    double last_change = std::numeric_limits<double>::infinity();
    for (int iteration = 0;; ++iteration) {
      then.a = a_by_u * (then.u - coast);
      then.v = coasting + gamma * dt * then.a;
      auto const state = assemble(system.body, then.u);
      Eigen::VectorXd const pull = state.force + system.external;
      Eigen::VectorXd const inert = system.mass * (then.a + damping * then.v);
      Eigen::VectorXd const residual = system.problem.restrict(Eigen::VectorXd(pull - inert));
      double const scale = std::max({system.external.norm(), state.force.norm(), inert.norm()});
      double const size = residual.norm();
      // Where forces cancel to rounding, the displacement tells.
      bool const settled = last_change <= 1e-14 * (then.u.norm() + dt * then.v.norm());
      if (std::isfinite(size) && (size <= options_.tolerance * scale || settled)) return then;
      if (iteration == options_.max_iterations || !std::isfinite(size))
        throw Error("Newmark: no convergence in the step to time ", system.body.time(), " s after ",
                    iteration, " iterations, residual ", size,
                    " N; take smaller steps, or a law that does not soften");
      Eigen::SparseMatrix<double> const matrix = system.problem.restrict(state.stiffness) + inertia;
      Eigen::VectorXd const du =
          detail::solve("Newmark", matrix, residual, system.body.pressures().empty());
      system.problem.add(then.u, du, 1);
      last_change = du.norm();
    }
  }

  template <std::size_t Dim>
  static Eigen::VectorXd vector_of(std::vector<std::array<double, Dim>> const& points) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(Dim * points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < Dim; ++k)
        values[static_cast<Eigen::Index>(Dim * i + k)] = points[i][k];
    return values;
  }
  template <class TheBody>
  void store(TheBody& body, State const& state) {
    auto const points = [&](Eigen::VectorXd const& values) {
      std::vector<Point<TheBody::dim>> list(static_cast<std::size_t>(body.nodes()));
      for (std::size_t i = 0; i < list.size(); ++i)
        for (std::size_t k = 0; k < TheBody::dim; ++k)
          list[i][k] = values[static_cast<Eigen::Index>(TheBody::dim * i + k)];
      return list;
    };
    body.set_displacements(points(state.u));
    body.set_velocities(points(state.v));
    body_ = &body;
    revision_ = body.revision();
    last_ = state;
    seen_ = {vector_of(body.displacements()), vector_of(body.velocities()), {}};
  }

  NewmarkOptions options_;
  void const* body_ = nullptr;
  long revision_ = 0;
  State last_, seen_;  // as it was left, and as the body has it
};

}  // namespace pliant

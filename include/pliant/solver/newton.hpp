#pragma once

#include <cmath>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <pliant/solver/assemble.hpp>

namespace pliant {

struct NewtonOptions {
  int load_steps = 1;        // gravity, loads, pressures and motions grow in so many equal steps
  int max_iterations = 50;   // per load step
  double tolerance = 1e-11;  // of the residual, relative to the external forces and reactions
};

struct NewtonReport {
  Index unknowns = 0;
  int iterations = 0;   // in all
  double residual = 0;  // N, the last
  double energy = 0;    // strain energy, J
};

namespace detail {

/// A body's unknowns, loads and prescribed displacements as vectors over (node, direction).
template <class TheBody>
class StaticProblem {
 public:
  static constexpr int dim = TheBody::dim;

  explicit StaticProblem(TheBody const& body)
      : body_(body), unknown_(static_cast<std::size_t>(dim * body.nodes()), -1) {
    std::vector<bool> fixed(unknown_.size(), false);
    for (auto const& condition : body.conditions())
      for (Index node : condition.nodes)
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) fixed[at(dim * node + k)] = true;
    for (Index i = 0; i < body.nodes(); ++i)
      if (!(body.masses()[at(i)] > 0))  // slaves, and nodes of no element
        for (int k = 0; k < dim; ++k) fixed[at(dim * i + k)] = true;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (!fixed[i]) unknown_[i] = unknowns_++;
    external = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknown_.size()));
    for (Index i = 0; i < body.nodes(); ++i)
      for (int k = 0; k < dim; ++k) {
        external[dim * i + k] = body.masses()[at(i)] * body.gravity()[at(k)];
        if (!body.loads().empty()) external[dim * i + k] += body.loads()[at(i)][at(k)];
      }
    for (auto const& slave : body.layout().slave_list)
      for (int k = 0; k < dim; ++k) {
        double const own = std::exchange(external[dim * slave.node + k], 0.0);
        for (auto const& [master, weight] : slave.masters)
          external[dim * master + k] += weight * own;
      }
  }

  Eigen::VectorXd external;  // N

  Index unknowns() const { return unknowns_; }

  /// The present displacement.
  Eigen::VectorXd start() const {
    auto const points = body_.displacements();
    Eigen::VectorXd u(static_cast<Eigen::Index>(unknown_.size()));
    for (Index i = 0; i < body_.nodes(); ++i)
      for (int k = 0; k < dim; ++k) u[dim * i + k] = points[at(i)][at(k)];
    return u;
  }
  /// Puts driven nodes at a share of their motion at the body's time.
  void prescribe(Eigen::VectorXd& u, double share) const {
    for (auto const& condition : body_.conditions()) {
      if (!condition.motion) continue;
      auto const to = condition.motion(body_.time());
      for (Index node : condition.nodes)
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) u[dim * node + k] = share * to[at(k)];
    }
  }
  Eigen::VectorXd restrict(Eigen::VectorXd const& full) const {
    Eigen::VectorXd reduced(unknowns_);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
      if (unknown_[i] >= 0) reduced[unknown_[i]] = full[static_cast<Eigen::Index>(i)];
    return reduced;
  }
  Eigen::SparseMatrix<double> restrict(Eigen::SparseMatrix<double> const& full) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < full.outerSize(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator it(full, column); it; ++it)
        if (unknown_[at(it.row())] >= 0 && unknown_[at(column)] >= 0)
          entries.emplace_back(unknown_[at(it.row())], unknown_[at(column)], it.value());
    Eigen::SparseMatrix<double> reduced(unknowns_, unknowns_);
    reduced.setFromTriplets(entries.begin(), entries.end());
    return reduced;
  }
  void add(Eigen::VectorXd& u, Eigen::VectorXd const& reduced, double factor) const {
    for (std::size_t i = 0; i < unknown_.size(); ++i)
      if (unknown_[i] >= 0) u[static_cast<Eigen::Index>(i)] += factor * reduced[unknown_[i]];
    interpolate_slaves(body_, u);
  }

 private:
  template <class I>
  static std::size_t at(I i) {
    return static_cast<std::size_t>(i);
  }
  TheBody const& body_;
  std::vector<Index> unknown_;
  Index unknowns_ = 0;
};

/// `solver`: whose errors these are.
inline Eigen::VectorXd solve(char const* solver, Eigen::SparseMatrix<double> const& k,
                             Eigen::VectorXd const& r, bool is_symmetric) {
  Error const singular(std::string(solver) +
                       ": the matrix is singular; hold the body against rigid motion, or look for "
                       "a collapsed element");
  if (Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> symmetric;
      is_symmetric && (symmetric.compute(k), symmetric.info() == Eigen::Success)) {
    Eigen::VectorXd const pivots = symmetric.vectorD().cwiseAbs();
    // Rounding makes a pivot that should be zero some 1e-16 of the others.
    if (pivots.minCoeff() < 1e-13 * pivots.maxCoeff()) throw singular;
    Eigen::VectorXd x = symmetric.solve(r);
    if (x.allFinite()) return x;
  }
  Eigen::SparseLU<Eigen::SparseMatrix<double>> general(k);
  if (general.info() != Eigen::Success) throw singular;
  return general.solve(r);
}

}  // namespace detail

/// Brings a body into static equilibrium with its gravity, loads and conditions: Newton's method on
/// the assembled matrix, in double precision whatever the body's own, with load steps and a line
/// search: on the potential energy, or, as pressures that follow a surface have none, on the work of
/// the residual along the step (Matthies and Strang, International Journal for Numerical Methods in
/// Engineering 14 (1979) 1613). Done within the tolerance, or when a step no longer moves anything but
/// the last digits. Internal variables are brought to rest. Velocities are left alone. Throws
/// Error, with the body as it was, where the matrix is singular or the iteration does not converge.
template <class TheBody>
NewtonReport solve_static(TheBody& body, NewtonOptions options = {}) {
  if (options.load_steps < 1 || options.max_iterations < 1 || !(options.tolerance > 0))
    throw Error(
        "solve_static: load_steps and max_iterations must be at least 1, and tolerance positive");
  detail::StaticProblem<TheBody> const problem(body);
  bool const conservative = body.pressures().empty();
  Eigen::VectorXd u = problem.start();
  NewtonReport report{.unknowns = problem.unknowns()};

  for (int step = 1; step <= options.load_steps; ++step) {
    double const share = static_cast<double>(step) / options.load_steps;
    problem.prescribe(u, share);
    problem.add(u, Eigen::VectorXd::Zero(problem.unknowns()), 0);
    Eigen::VectorXd const load = share * problem.external;
    auto state = assemble(body, u, Assemble::stiffness_too, share);
    bool settled = false;
    for (int iteration = 0;; ++iteration) {
      Eigen::VectorXd const residual = problem.restrict(Eigen::VectorXd(state.force + load));
      double const scale = std::max(load.norm(), state.force.norm());
      report.residual = residual.norm();
      report.energy = state.energy;
      bool const finite = std::isfinite(report.residual) && std::isfinite(state.energy);
      if (finite && (settled || report.residual <= options.tolerance * scale)) break;
      if (iteration == options.max_iterations || !finite)
        throw Error("solve_static: no convergence in load step ", step, " of ", options.load_steps,
                    " after ", iteration, " iterations, residual ", report.residual,
                    " N; use more load_steps, or a law that does not soften");
      Eigen::VectorXd const du =
          detail::solve("solve_static", problem.restrict(state.stiffness), residual, conservative);
      double factor = 1;
      Eigen::VectorXd trial;
      double const potential = state.energy - load.dot(u);
      for (int halving = 0;; ++halving, factor /= 2) {
        trial = u;
        problem.add(trial, du, factor);
        auto const next = assemble(body, trial, Assemble::energy_and_force, share);
        Eigen::VectorXd const left = problem.restrict(Eigen::VectorXd(next.force + load));
        bool const better = conservative ? next.energy - load.dot(trial) <= potential
                                         : std::abs(du.dot(left)) < std::abs(du.dot(residual));
        if (halving == 20 || (std::isfinite(left.norm()) && std::isfinite(next.energy) &&
                              (better || left.norm() < report.residual)))
          break;
      }
      u = trial;
      settled = factor == 1 && du.norm() <= 1e-14 * u.norm();
      state = assemble(body, u, Assemble::stiffness_too, share);
      ++report.iterations;
    }
  }
  std::vector<Point<TheBody::dim>> points(static_cast<std::size_t>(body.nodes()));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < points[i].size(); ++k)
      points[i][k] = u[static_cast<Eigen::Index>(i * points[i].size() + k)];
  body.set_displacements(points);
  if constexpr (TheBody::has_internal_variables) body.equilibrate();
  return report;
}

}  // namespace pliant

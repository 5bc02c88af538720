#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <pliant/solver/linear/conjugate_gradients.hpp>
#include <pliant/solver/linear/direct_solver.hpp>
#include <pliant/solver/linear/linear_solver.hpp>
#include <pliant/solver/linear/minres.hpp>
#include <pliant/solver/linear/multilevel.hpp>

namespace pliant::detail {

template <int Dim>
class LinearSolver<Dim>::Methods {
 public:
  Methods(std::string name, LinearMethod method) : direct_(std::move(name)), method_(method) {}

  double reached() const { return reached_; }
  bool indefinite() const {
    return report_.method == LinearMethod::direct ? direct_.indefinite() : indefinite_;
  }
  LinearReport report() const {
    auto report = report_;
    report.factorisations = direct_.factorisations();
    return report;
  }

  void begin_anew() {
    serves_ = false;
    iterations_per_digit_ = 0;
    failures_ = 0;
  }

  Eigen::VectorXd solve(HostTasks const& tasks, LinearSystem<Dim> const& system, Eigen::VectorXd r,
                        double tolerance) {
    system.unknowns.keep(r);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(r.size());
    if (system.symmetric && wants_multilevel(system)) {
      if (by_multilevel(tasks, system, r, tolerance, x)) return x;
      multilevel_.reset();
      ++failures_;
    }
    report_.method = LinearMethod::direct;
    reached_ = 0;
    if (serves_ && system.symmetric && by_kept_factors(tasks, system, r, tolerance, x)) return x;
    serves_ = true;
    return system.unknowns.expand(direct_.solve(system.unknowns.restrict(system.matrix),
                                                system.unknowns.restrict(r), system.symmetric));
  }

 private:
  /// Unknowns from where on hierarchies were faster than factors, on sheets and blocks under neo-Hooke's law.
  static constexpr Index many = Dim == 2 ? 4000 : 1000;
  /// Matrices for which the multilevel method did not work are factorised; others after them too.
  static constexpr int few_failures = 2;

  bool wants_multilevel(LinearSystem<Dim> const& system) const {
    if (method_ != LinearMethod::automatic) return method_ == LinearMethod::multilevel;
    return failures_ < few_failures && system.unknowns.count() >= many;
  }

  bool by_multilevel(HostTasks const& tasks, LinearSystem<Dim> const& system,
                     Eigen::VectorXd const& r, double tolerance, Eigen::VectorXd& x) {
    report_.method = LinearMethod::multilevel;
    BlockMatrix<Dim, Dim> a = system.matrix;
    system.unknowns.isolate_others(a);
    for (bool const fresh : {false, true}) {
      if (!fresh && (!multilevel_ || multilevel_->matrix().rows() != a.rows() ||
                     !(serves_ || multilevel_->matrix().values == a.values)))
        continue;
      serves_ = true;
      if (fresh) {
        multilevel_ =
            std::make_unique<Multilevel<Dim>>(tasks, a, system.nodes, system.unknowns.fixed());
        ++report_.hierarchies;
        if (!multilevel_->is_definite()) return false;
      }
      auto const apply_a = [&](auto const& v, auto& out) { multiply(tasks, a, v, out); };
      auto const apply_m = [&](auto const& v, auto& out) { multilevel_->apply(tasks, v, out); };
      int const most = most_iterations(system, tolerance);
      auto found =
          conjugate_gradients(apply_a, apply_m, r, x, tolerance, fresh ? most : allowed(tolerance));
      report_.iterations += found.iterations;
      indefinite_ = found.indefinite;
      if (indefinite_) {  // the hierarchy is definite: it is of this matrix or an earlier one
        found = minres(apply_a, apply_m, r, x, tolerance, most);
        report_.iterations += found.iterations;
        ++report_.minres;
      }
      if (found.converged) {
        note_reached(found, r);
        if (fresh && !indefinite_ && found.iterations > 0)
          iterations_per_digit_ = found.iterations / digits(tolerance);
        return true;
      }
    }
    return false;
  }
  static double digits(double tolerance) { return std::max(1.0, -std::log10(tolerance)); }
  /// Iterations after which a kept hierarchy has become too bad.
  int allowed(double tolerance) const {
    return 8 + static_cast<int>(2 * iterations_per_digit_ * digits(tolerance));
  }
  /// Iterations after which a matrix is better factorised: near incompressibility, or where elements are slivers. In
  /// three dimensions factors of large matrices are worth more of them.
  int most_iterations(LinearSystem<Dim> const& system, double tolerance) const {
    double const worth =
        Dim == 2 || system.unknowns.count() < 20000 ? 1 : system.unknowns.count() / 20000.0;
    double const few = 5 * (2 + digits(tolerance)) * worth;
    return method_ == LinearMethod::multilevel ? 500 : static_cast<int>(std::min(few, 500.0));
  }

  bool by_kept_factors(HostTasks const& tasks, LinearSystem<Dim> const& system,
                       Eigen::VectorXd const& r, double tolerance, Eigen::VectorXd& x) {
    int const worth = direct_.solves_worth_a_factorisation() / 3;
    if (worth < 4 || !direct_.fits(system.unknowns.count())) return false;
    auto const& unknowns = system.unknowns;
    auto const cg = conjugate_gradients(
        [&](auto const& v, auto& out) {
          multiply(tasks, system.matrix, v, out);
          unknowns.keep(out);
        },
        [&](auto const& v, auto& out) {
          out = unknowns.expand(direct_.apply(unknowns.restrict(v)));
        },
        r, x, tolerance, worth);
    report_.iterations += cg.iterations;
    if (cg.converged) note_reached(cg, r);
    return cg.converged;
  }
  void note_reached(KrylovReport const& found, Eigen::VectorXd const& r) {
    double const size = r.norm();
    reached_ = size > 0 ? found.residual / size : 0;
  }

  DirectSolver direct_;
  std::unique_ptr<Multilevel<Dim>> multilevel_;
  LinearMethod method_;
  LinearReport report_;
  double iterations_per_digit_ = 0, reached_ = 0;
  int failures_ = 0;
  bool indefinite_ = false;  // the last matrix of the multilevel method
  bool serves_ = false;      // whether what is kept is of a matrix that this one follows
};

template <int Dim>
LinearSolver<Dim>::LinearSolver(std::string name, LinearMethod method)
    : methods_(std::make_unique<Methods>(std::move(name), method)) {}
template <int Dim>
LinearSolver<Dim>::LinearSolver(LinearSolver&&) noexcept = default;
template <int Dim>
LinearSolver<Dim>& LinearSolver<Dim>::operator=(LinearSolver&&) noexcept = default;
template <int Dim>
LinearSolver<Dim>::~LinearSolver() = default;

template <int Dim>
double LinearSolver<Dim>::reached() const {
  return methods_->reached();
}
template <int Dim>
bool LinearSolver<Dim>::indefinite() const {
  return methods_->indefinite();
}
template <int Dim>
LinearReport LinearSolver<Dim>::report() const {
  return methods_->report();
}
template <int Dim>
void LinearSolver<Dim>::begin_anew() {
  methods_->begin_anew();
}
template <int Dim>
Eigen::VectorXd LinearSolver<Dim>::solve(HostTasks const& tasks, LinearSystem<Dim> const& system,
                                         Eigen::VectorXd r, double tolerance) {
  return methods_->solve(tasks, system, std::move(r), tolerance);
}

}  // namespace pliant::detail

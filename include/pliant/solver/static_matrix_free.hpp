#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/solver/implicit/balance.hpp>
#include <pliant/solver/least_jacobian_on.hpp>
#include <pliant/solver/load_steps.hpp>

namespace pliant::detail {

/// Newton's method for rest without a matrix, in the memory of a body's backend and in its precision: the load steps and
/// the line search of solve_static, with Krylov methods for the linear systems. For forces that have a potential.
template <class Parts>
class MatrixFreeStatics {
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Field = typename Parts::Field;
  using ConstField = typename Parts::ConstField;
  using Array = typename Parts::template Array<T>;

 public:
  /// `from`: displacements, where load steps begin.
  MatrixFreeStatics(Parts& parts, NewtonOptions const& options, Array const& from)
      : parts_(parts),
        options_(options),
        balance_(parts, options.gravity, 0),
        preconditioning_(options.preconditioner),
        nodes_(parts.layout.rows),
        u_(array()),
        start_(array()),
        external_(array()),
        grown_(array()) {
    copy(from, u_);
    parts.layout.interpolation.apply(parts.backend, field(u_));
    copy(u_, start_);
    balance_.weigh(field(external_));
  }

  NewtonReport solve() {
    auto& own = balance_.arrays();
    auto const prescribed = field(own.speed);
    Array balance;
    Array& reached = own.increment;
    copy(u_, reached);
    ask_motions(parts_, parts_.state.time, 0);
    auto const take = [&](LoadStep const& step) {
      double const share = step.to;
      if (share < 1 && balance.size() == 0) {
        // What is in balance where the body is: loads grow from there.
        evaluate(start_, 0);
        balance = array();
        copy(own.residual, balance);
      }
      set(field(grown_), balance_.scaled(share, field(external_)),
          balance_.scaled(share < 1 ? -(1 - share) : 0, field(balance)));
      // Where driven nodes are to be: start + share (end − start).
      set(prescribed, balance_.scaled(1, field(start_)));
      for (auto const& driven : parts_.driven)
        driven.place(parts_.backend, prescribed, field(own.trial));
      set(prescribed, balance_.scaled(share, prescribed),
          balance_.scaled(1 - share, field(start_)));
      iterate(step);
      if (share == 1) refuse_folds(options_, least_jacobian_on(parts_, {u_.data()}, false));
      copy(u_, reached);
    };
    report_.load_steps = follow_loads(options_, take, [&] {
      copy(reached, u_);
      preconditioning_.begin_anew();
    });
    report_.unknowns = count_unknowns(parts_);
    report_.linear = preconditioning_.report();
    report_.linear.method = LinearMethod::matrix_free;
    report_.least_J = least_jacobian_on(parts_, {u_.data()}, true);
    return report_;
  }
  Array const& displacements() const { return u_; }

  /// Node by node, in the user's order.
  using Points = std::vector<Point<dim>>;
  Points points() const { return parts_.layout.in_user_order(u_); }
  void set(Points const& u) { u_.upload(parts_.layout.padded(u)); }
  /// What a residual asks of the displacements that were found.
  Points correction(Points const& residual, double tolerance) {
    auto& own = balance_.arrays();
    own.residual.upload(parts_.layout.padded(residual));
    keep_unknowns(parts_, field(own.residual));
    solve_matrix_free(parts_, own, tangent(), tolerance, options_.max_linear_iterations,
                      preconditioning_, options_.krylov);
    return parts_.layout.in_user_order(own.solution);
  }

 private:
  ShiftedTangent<Parts> tangent() const {
    return {0, MassMatrix::lumped, 1, {u_.data()}, 0, {u_.data()}};
  }
  Array array() const { return zeros<T>(parts_.backend, parts_.layout.rest.size()); }
  Field field(Array const& array) const { return {const_cast<T*>(array.data())}; }
  template <class... Terms>
  void set(Field out, Terms const&... terms) const {
    set_sum(parts_.backend, nodes_, out, terms...);
  }
  void copy(Array const& from, Array& to) const {
    set(field(to), balance_.scaled(1, ConstField{from.data()}));
  }
  double dot(Array const& a, Array const& b) const {
    return parts_.backend.sum(nodes_, DotAt<T, dim>{{a.data()}, {b.data()}});
  }
  struct Evaluated {
    double potential;        // J
    double residual, scale;  // N
  };
  /// F(u) + loads over the unknowns into arrays.residual; loads: a share of what has grown.
  Evaluated evaluate(Array const& u, double loads) {
    auto& own = balance_.arrays();
    auto const f = field(own.force), r = field(own.residual);
    clear_rows(parts_, f);
    double energy = 0;
    for_each_force_term(parts_, [&](auto const& term) {
      term.add_force(parts_.backend, parts_.at({u.data()}), f);
      energy += term.energy(parts_.backend, parts_.at({u.data()}));
    });
    parts_.layout.interpolation.apply_transpose(parts_.backend, f);
    set(r, balance_.scaled(1, f), balance_.scaled(loads, field(grown_)));
    keep_unknowns(parts_, r);
    report_.energy = energy;
    double const pull = std::sqrt(dot(grown_, grown_)) * loads;
    return {energy - loads * dot(grown_, u), std::sqrt(dot(own.residual, own.residual)),
            std::max(pull, std::sqrt(dot(own.force, own.force)))};
  }
  bool is_unfolded(Array const& u) {
    return least_jacobian_on(parts_, {u.data()}, false).value > 0;
  }

  /// One load step.
  void iterate(LoadStep const& step) {
    auto& own = balance_.arrays();
    auto const increment = field(own.trial), target = field(own.speed);
    double const eps = 45 * double{std::numeric_limits<T>::epsilon()};
    auto now = evaluate(u_, 1);
    bool settled = false;
    double forcing = first_forcing;
    for (int iteration = 0;; ++iteration) {
      // The increment of driven nodes, with their slaves.
      parts_.backend.for_each(nodes_, Clear<T>{increment.data});
      parts_.backend.for_each(
          nodes_, TakeHeld<T, dim>{increment, {target.data}, parts_.layout.held.data()});
      parts_.backend.for_each(nodes_,
                              LessHeld<T, dim>{increment, {u_.data()}, parts_.layout.held.data()});
      parts_.layout.interpolation.apply(parts_.backend, increment);
      bool const driving = dot(own.trial, own.trial) > 0;
      report_.residual = now.residual;
      if (iteration == 0) report_.residuals.clear();
      report_.residuals.push_back(now.residual);
      bool const finite = std::isfinite(now.residual) && std::isfinite(now.potential);
      if (!driving && finite && (settled || now.residual <= options_.tolerance * now.scale)) return;
      if (!finite && iteration == 0) throw Error(folded_start());
      if (iteration == options_.max_iterations || !finite)
        throw LoadStepFailed(no_convergence(step, iteration, report_.residual));
      auto const a = tangent();
      if (driving) {
        a.apply(parts_, increment, field(own.image));
        set(field(own.residual), balance_.scaled(1, field(own.residual)),
            balance_.scaled(-1, field(own.image)));
      }
      double const pull = std::sqrt(dot(own.residual, own.residual));
      double const enough = std::max(driving ? driving_forcing : forcing,
                                     0.1 * options_.tolerance * now.scale / pull);
      auto const found =
          solve_matrix_free(parts_, own, a, std::min(enough, 0.1), options_.max_linear_iterations,
                            preconditioning_, options_.krylov);
      report_.indefinite = found.indefinite;
      if (found.indefinite && found.iterations == 0) {
        auto const text =
            message({"solve_static: the stiffness is not positive definite ", step.name(),
                     "; use more load_steps, KrylovMethod::minres or LinearMethod::direct"});
        if (iteration == 0) throw Error(text);
        throw LoadStepFailed(text);
      }
      settled = search(now, driving);
      forcing = std::clamp(0.9 * square(now.residual / pull), 1e-6, first_forcing);
      settled = settled && !driving &&
                std::sqrt(dot(own.solution, own.solution)) <= eps * std::sqrt(dot(u_, u_));
      ++report_.iterations;
    }
  }
  /// Goes along the solution, and the increment of driven nodes, as far as it leads down; whether all the way.
  bool search(Evaluated& now, bool driving) {
    auto& own = balance_.arrays();
    bool const unfolded = driving && is_unfolded(u_);
    double const potential = now.potential, residual = now.residual;
    for (int halving = 0;; ++halving) {
      double const factor = std::ldexp(1.0, -halving);
      auto const trial = field(own.place);
      set(trial, balance_.scaled(1, field(u_)), balance_.scaled(factor, field(own.solution)),
          balance_.scaled(driving ? factor : 0, field(own.trial)));
      if (driving && factor == 1)
        parts_.backend.for_each(
            nodes_, TakeHeld<T, dim>{trial, {own.speed.data()}, parts_.layout.held.data()});
      parts_.layout.interpolation.apply(parts_.backend, trial);
      now = evaluate(own.place, 1);
      bool const finite = std::isfinite(now.residual) && std::isfinite(now.potential);
      bool const better = driving ? !unfolded || is_unfolded(own.place)
                                  : now.potential <= potential || now.residual < residual;
      if (halving < 20 && !(finite && better)) continue;
      copy(own.place, u_);
      return factor == 1;
    }
  }

  static constexpr double first_forcing = 1e-3, driving_forcing = 1e-6;
  Parts& parts_;
  NewtonOptions const& options_;
  Balance<Parts> balance_;
  Preconditioning<Parts> preconditioning_;
  Index nodes_;
  Array u_, start_, external_, grown_;
  NewtonReport report_{};
};

}  // namespace pliant::detail

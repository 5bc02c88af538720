#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

#include <pliant/solver/implicit/balance.hpp>
#include <pliant/solver/implicit/carried_errors.hpp>
#include <pliant/solver/implicit/options.hpp>
#include <pliant/solver/implicit/step_solver.hpp>
#include <pliant/solver/linear/same_registers.hpp>

namespace pliant {

/// Implicit time integration by a scheme: BackwardEuler, Newmark, GeneralizedAlpha, BDF2 or a user's own (see
/// StepRule). One residual for all of them, on the body's backend and in its precision, brought to zero by Newton's
/// method: M a + c M v + s K v = F(u) + loads + M g. For steps longer than the explicit ones. Laws with internal
/// variables see the step; hanging nodes, pressures and driven nodes are those of the body.
///
///   Implicit step{BDF2{}, {.step = 1e-2}};
///   step(body, 100);
///
/// What it needs from call to call stands in the body's state: a body that is saved, copied or rolled back goes on
/// with the same bits, by this object or another with the same scheme and options.
template <ImplicitScheme Scheme>
class Implicit {
 public:
  /// Throws Error for options that cannot work: see ImplicitOptions.
  Implicit(Scheme const& scheme, ImplicitOptions const& options)
      : scheme_(scheme),
        options_(options),
        plane_(Scheme::name, options.linear),
        solid_(Scheme::name, options.linear) {
    scheme.check();
    if (!(options.step > 0 && std::isfinite(options.step)))
      throw Error(Scheme::name, ": step ", options.step, " s; give a positive, finite step");
    if (options.max_iterations < 1 || options.max_linear_iterations < 1)
      throw Error(Scheme::name, ": max_iterations ", options.max_iterations,
                  " and max_linear_iterations ", options.max_linear_iterations, "; give 1 or more");
    if (double const tolerance = options.tolerance.value_or(detail::usual_implicit_tolerance);
        !(tolerance > 0 && tolerance < 1))
      throw Error(Scheme::name, ": a tolerance of ", tolerance,
                  "; give a number between 0 and 1, relative to the forces");
    if (!(options.error >= 0 && std::isfinite(options.error)))
      throw Error(Scheme::name, ": an error of ", options.error,
                  " m; give a finite one above 0, or 0 for steps of one size");
    if (!(options.stiffness_damping >= 0 && std::isfinite(options.stiffness_damping)))
      throw Error(Scheme::name, ": a stiffness damping of ", options.stiffness_damping,
                  " s; give a finite number that is not negative");
  }

  /// Takes steps. Throws Error where a step does not converge or folds the body (det F ≤ 0, looked for all over each
  /// element whose law is not linear), and is not to be made shorter; the body is then exactly as the last step that
  /// was good left it.
  template <DeformableBody TheBody>
  ImplicitReport operator()(TheBody& body, int steps = 1) {
    if (steps < 0) throw Error(Scheme::name, ": ", steps, " steps; give 0 or more");
    return run(body, [steps](ImplicitReport const& report, double) {
      return report.steps < steps ? std::numeric_limits<double>::infinity() : 0;
    });
  }
  /// Takes steps up to a time, s, at which the last one ends.
  template <DeformableBody TheBody>
  ImplicitReport until(TheBody& body, double time) {
    if (!(time >= body.time()) || !std::isfinite(time))
      throw Error(Scheme::name, ": the body is at time ", body.time(), " s; ", time,
                  " s is not a later one");
    return run(body, [time](ImplicitReport const&, double now) {
      // What is left of rounding is no step.
      return time - now > 1e-12 * std::abs(time) ? time - now : 0.0;
    });
  }

 private:
  template <int Dim>
  detail::LinearSolver<Dim>& linear() {
    if constexpr (Dim == 2)
      return plane_;
    else
      return solid_;
  }

  /// Steps while left(report, time) is positive, s.
  template <class TheBody, class Left>
  ImplicitReport run(TheBody& body, Left const& left) {
    detail::check_registers();
    ImplicitReport report{.time = body.time()};
    if (!(left(report, body.time()) > 0)) return report;
    Run<TheBody> now(*this, body, report);
    for (double rest; (rest = left(report, body.time())) > 0;) now.step(rest);
    now.finish();
    return report;
  }

  /// The steps of one call.
  template <DeformableBody TheBody>
  class Run {
    static constexpr int dim = TheBody::dim;
    using Parts = typename TheBody::parts_type;
    using T = typename Parts::T;
    using Field = typename Parts::Field;

   public:
    Run(Implicit& integrator, TheBody& body, ImplicitReport& report)
        : integrator_(integrator),
          options_(integrator.options_),
          parts_(begin(body.parts())),
          solver_(body, options_, integrator.template linear<dim>(), report),
          balance_(solver_.balance()),
          errors_(parts_, balance_, options_.mass, options_.stiffness_damping),
          report_(report),
          carries_(options_.errors == ErrorEstimate::carried ||
                   (options_.errors == ErrorEstimate::automatic && options_.error > 0)) {
      begin_motion();
    }

    /// A step of at most `most` seconds.
    void step(double most) {
      auto& kept = parts_.state.implicit;
      double h = options_.error > 0 && kept.next_step > 0 ? kept.next_step : options_.step;
      bool const cut = h > most * (1 - 1e-9);
      double const asked = h;
      if (cut) h = most;
      for (;; ++report_.rejected) {
        try {
          solver_.take(integrator_.scheme_.rule(h, kept.step), h);
        } catch (detail::StepNotTaken const& why) {
          if (options_.error == 0 || h < 1e-6 * options_.step) throw Error(why.message);
          h /= 4;
          continue;
        }
        double const error = step_error(h);
        if (options_.error > 0 && error > options_.error) {
          h *= std::max(0.2, 0.8 * growth(error));
          continue;
        }
        report_.error = error;
        if (carries_) carry_errors(h);
        accept(h);
        tell_errors();
        if (options_.error > 0)
          kept.next_step = std::max(cut ? asked : 0.0, h * std::clamp(growth(error), 0.3, 2.0));
        return;
      }
    }
    void finish() { solver_.finish(); }

   private:
    /// Takes the body over, with all patches awake and velocities of the present time.
    static Parts& begin(Parts& parts) {
      synchronize_velocities(parts);
      wake_all(parts);
      parts.integrator = nullptr;
      parts.add_watched_term = nullptr;
      parts.has_checkpoint = false;
      parts.state.integrator.active = false;  // explicit integrators begin anew
      return parts;
    }
    void begin_motion() {
      auto& kept = parts_.state.implicit;
      auto const make = [&](auto& array) {
        if (array.size() == 0) array = zeros<T>(parts_.backend, parts_.layout.rest.size());
      };
      if (kept.empty()) take_speed_of_motions();
      begin_errors();
      if (Scheme::looks_back && kept.d_before.size() == 0) kept.step = 0;
      make(kept.a);
      if constexpr (Scheme::looks_back) {
        make(kept.d_before);
        make(kept.v_before);
      }
      auto const mass = static_cast<std::int32_t>(options_.mass);
      if (Scheme::order < 2 || (kept.balanced && kept.mass == mass)) return;
      set_step_size(parts_, 0);
      balance_.find_acceleration();
      kept.balanced = true;
      kept.mass = mass;
    }
    void begin_errors() {
      auto& kept = parts_.state.implicit;
      if (carries_) return errors_.begin(Scheme::looks_back);
      for (auto* array : {&kept.error_u, &kept.error_v, &kept.error_a, &kept.error_d_before,
                          &kept.error_v_before})
        *array = {};
      kept.error = kept.farthest = 0;
    }
    /// Gives driven nodes the mean velocity of their motions over the step before now, or over the first one where none
    /// was before.
    void take_speed_of_motions() {
      double const now = parts_.state.time, h = options_.step;
      ask_motions(parts_, now >= h ? now : now + h, h);
      auto const nowhere = balance_.field(balance_.arrays().trial);
      for (auto const& driven : parts_.driven) driven.place(parts_.backend, nowhere, parts_.v());
      parts_.layout.interpolation.apply(parts_.backend, parts_.v());
    }

    /// What the step has beyond an extrapolation, times what of that is an error, m, into arrays.trial.
    Field find_step_error(double h) {
      auto& own = balance_.arrays();
      auto const beyond = balance_.field(own.trial);
      double const share = solver_.rule().error_share;
      detail::set_sum(parts_.backend, parts_.layout.rows, beyond,
                      balance_.scaled(share, balance_.field(own.increment)),
                      balance_.scaled(-share * h, parts_.v()),
                      balance_.scaled(Scheme::order > 1 ? -share * h * h / 2 : 0,
                                      balance_.field(parts_.state.implicit.a)));
      detail::keep_unknowns(parts_, beyond);
      return beyond;
    }
    double largest(Field field) const {
      return parts_.backend.maximum(parts_.layout.rows, detail::LargestAt<T, dim>{{field.data}});
    }
    /// The largest error of a displacement, m.
    double step_error(double h) { return largest(find_step_error(h)); }
    /// To the end of the step, which is not yet the body's state.
    void carry_errors(double h) {
      auto& kept = parts_.state.implicit;
      errors_.find_residual(solver_.rule());
      if (balance_.norm(balance_.arrays().residual) > 0) {
        // Where a body is about to buckle, the residual hardly shows the part of δd that grows.
        if (!solver_.solve(1e-4, h)) kept.error = std::numeric_limits<double>::infinity();
      } else {
        auto const nothing = balance_.field(balance_.arrays().solution);
        detail::set_sum(parts_.backend, parts_.layout.rows, nothing, balance_.scaled(0, nothing));
      }
      double const off = errors_.go_on(solver_.rule(), Scheme::looks_back, find_step_error(h));
      // Twice, as errors of steps are of velocities too, and twice for what the first order leaves out.
      kept.error = std::max(kept.error, 4 * off);
    }
    void tell_errors() {
      auto& kept = parts_.state.implicit;
      if (!carries_) {
        report_.error_in_all += 2 * report_.error;
        return;
      }
      kept.farthest = std::max(kept.farthest, largest(parts_.u()));
      report_.errors = ErrorEstimate::carried;
      report_.error_in_all = kept.error;
      report_.errors_lost = !(kept.error <= 0.1 * kept.farthest);
    }
    double growth(double error) const {
      return 0.9 * std::pow(options_.error / std::max(error, 1e-300), 1.0 / (Scheme::order + 1));
    }
    /// Makes the end of the step the body's state.
    void accept(double h) {
      auto& own = balance_.arrays();
      auto& state = parts_.state;
      auto& kept = state.implicit;
      auto const& backend = parts_.backend;
      Index const n = parts_.layout.rows;
      auto const d = balance_.field(own.increment), speed = balance_.field(own.speed),
                 a = balance_.field(own.acceleration);
      balance_.set_end(speed, solver_.rule().velocity);
      balance_.set_end(a, solver_.rule().acceleration);
      if constexpr (Scheme::looks_back) {
        detail::set_sum(backend, n, balance_.field(kept.d_before), balance_.scaled(1, d));
        detail::set_sum(backend, n, balance_.field(kept.v_before), balance_.scaled(1, parts_.v()));
      }
      detail::set_sum(backend, n, parts_.v(), balance_.scaled(1, speed));
      detail::set_sum(backend, n, balance_.field(kept.a), balance_.scaled(1, a));
      detail::set_sum(backend, n, parts_.u(), balance_.scaled(1, parts_.u()),
                      balance_.scaled(1, d));
      for (auto const& driven : parts_.driven)
        driven.place(backend, parts_.u(), balance_.field(own.trial));
      for (auto field : {parts_.u(), parts_.v(), balance_.field(kept.a)})
        parts_.layout.interpolation.apply(backend, field);
      set_step_size(parts_, h);
      commit_at(parts_, std::as_const(parts_).u());
      forget_forces(parts_);
      state.time += h;
      ++state.steps;
      kept.step = h;
      kept.balanced = true;
      kept.mass = static_cast<std::int32_t>(options_.mass);
      ++report_.steps;
      report_.time = state.time;
      report_.step = h;
      report_.reached = std::max(report_.reached, solver_.reached());
      if (!(solver_.least().value >= report_.least_J.value)) report_.least_J = solver_.least();
    }

    Implicit& integrator_;
    ImplicitOptions const& options_;
    Parts& parts_;
    detail::StepSolver<Scheme, TheBody> solver_;
    detail::Balance<Parts>& balance_;
    detail::CarriedErrors<Parts> errors_;
    ImplicitReport& report_;
    bool carries_;  // errors
  };

  Scheme scheme_;
  ImplicitOptions options_;
  detail::LinearSolver<2> plane_;  // of bodies in two and three dimensions
  detail::LinearSolver<3> solid_;
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

#include <pliant/solver/implicit/assembled_steps.hpp>
#include <pliant/solver/implicit/balance.hpp>
#include <pliant/solver/implicit/balance_in_double.hpp>
#include <pliant/solver/implicit/carried_errors.hpp>
#include <pliant/solver/implicit/options.hpp>
#include <pliant/solver/least_jacobian_on.hpp>

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
    if (double const tolerance = options.tolerance.value_or(usual_tolerance);
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
  static constexpr double usual_tolerance = 1e-10;

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
          body_(body),
          parts_(begin(body.parts())),
          balance_(parts_, options_.mass, options_.stiffness_damping),
          errors_(parts_, balance_, options_.mass, options_.stiffness_damping),
          linear_(integrator.template linear<dim>()),
          before_(linear_.report()),
          preconditioning_(options_.preconditioner),
          report_(report),
          tolerance_(options_.tolerance.value_or(usual_tolerance)),
          carries_(options_.errors == ErrorEstimate::carried ||
                   (options_.errors == ErrorEstimate::automatic && options_.error > 0)) {
      bool const conservative = detail::is_conservative(body);
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
          take(h);
        } catch (NotTaken const& why) {
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

   private:
    /// Why a step was not taken.
    struct NotTaken {
      std::string message;
    };

    /// Takes the body over, with all patches awake and velocities of the present time.
    static Parts& begin(Parts& parts) {
      synchronize_velocities(parts);
      wake_all(parts);
      parts.integrator = nullptr;
      parts.watched_energy = nullptr;
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

    /// Solves for the step of size h, in arrays.increment: by full steps of Newton's method, and where these do not
    /// converge by steps of searched length.
    void take(double h) {
      auto const& state = parts_.state;
      rule_ = integrator_.scheme_.rule(h, state.implicit.step);
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
      if (!converged && !why_not_.empty()) throw NotTaken{why_not_};
      if (!converged)
        throw NotTaken{detail::message({Scheme::name, ": no convergence in the step to time ",
                                        state.time + h, " s after ", options_.max_iterations,
                                        " iterations, residual ", report_.residual,
                                        " N; take smaller steps, or a law that does not soften"})};
      look_for_folds(h);
    }
    using Size = typename detail::Balance<Parts>::Size;

    /// Newton's method. Whether it converged.
    bool iterate(double h, bool searching) {
      auto& own = balance_.arrays();
      Size now = begin_iteration(h, searching);
      double const eps = 45 * double{std::numeric_limits<T>::epsilon()};
      double const size = detail::norm_of(parts_.backend, parts_.layout.nodes, parts_.u()) +
                          h * detail::norm_of(parts_.backend, parts_.layout.nodes, parts_.v());
      constexpr double nothing = 1e6 * double{std::numeric_limits<T>::min()};  // N: without digits
      double forcing = 1e-3;
      bool settled = false;
      for (int iteration = 0;; ++iteration) {
        report_.residual = now.residual;
        if (!std::isfinite(now.residual)) return false;
        // Where forces cancel to rounding, the displacement tells.
        if (now.residual <= std::max(tolerance_ * now.scale, nothing) || settled) {
          reached_ = now.scale > 0 ? now.residual / now.scale : 0;
          return sizeof(T) == sizeof(double) || !options_.tolerance || now.residual <= nothing ||
                 reached_ <= tolerance_ || refine(h);
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
      auto const left = detail::refine_in_double(d, tolerance_, *in_double_, correct);
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
      Index const n = parts_.layout.nodes;
      auto const work = [&] {
        return parts_.backend.sum(n, detail::DotAt<T, dim>{{along.data}, {own.residual.data()}});
      };
      double const at_start = searching ? start_work_ : 0;
      double share = 0, next = searching && at_start < 0 ? -1 : 1;
      for (int trial = 0;; ++trial) {
        detail::set_sum(parts_.backend, n, d, balance_.scaled(1, d),
                        balance_.scaled(next - share, along));
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
      Index const n = parts_.layout.nodes;
      bool const bends = along && Scheme::order > 1;
      detail::set_sum(
          parts_.backend, n, d, balance_.scaled(along ? h : 0, parts_.v()),
          balance_.scaled(bends ? h * h / 2 : 0, balance_.field(parts_.state.implicit.a)));
      detail::set_sum(parts_.backend, n, place, balance_.scaled(1, parts_.u()));
      for (auto const& driven : parts_.driven)
        driven.place(parts_.backend, place, balance_.field(own.trial));
      detail::set_sum(parts_.backend, n, place, balance_.scaled(1, place),
                      balance_.scaled(-1, parts_.u()));
      parts_.backend.for_each(n,
                              detail::TakeHeld<T, dim>{d, {place.data}, parts_.layout.held.data()});
      parts_.layout.interpolation.apply(parts_.backend, d);
    }
    /// The change of the step by Newton's method, into arrays.solution. False where there is none.
    bool solve(double tolerance, double h) {
      auto& own = balance_.arrays();
      auto const matrix = balance_.matrix(rule_);
      auto const r = balance_.field(own.residual), kept = balance_.field(own.trial);
      detail::set_sum(parts_.backend, parts_.layout.nodes, kept, balance_.scaled(1, r));
      if (assembled_) {
        try {
          assembled_->solve(own, matrix, rule_.force_weight * h, tolerance);
        } catch (Error const& error) {
          why_not_ = error.what();
          return false;
        }
      } else {
        auto const found = detail::solve_matrix_free(parts_, own, matrix, tolerance,
                                                     options_.max_linear_iterations,
                                                     preconditioning_, options_.krylov);
        // Along a direction of negative curvature the iteration stops where it is: still a way down.
        if (found.iterations == 0 && found.indefinite) {
          why_not_ = detail::message({Scheme::name,
                                      ": the tangent is not positive definite; take smaller steps, "
                                      "KrylovMethod::minres or LinearMethod::direct"});
          return false;
        }
      }
      start_work_ = parts_.backend.sum(
          parts_.layout.nodes, detail::DotAt<T, dim>{{own.solution.data()}, {own.trial.data()}});
      return true;
    }
    void look_for_folds(double h) {
      auto& own = balance_.arrays();
      auto const end = balance_.field(own.trial);
      detail::set_sum(parts_.backend, parts_.layout.nodes, end, balance_.scaled(1, parts_.u()),
                      balance_.scaled(1, balance_.field(own.increment)));
      least_ = least_jacobian_on(parts_, {end.data}, true);
      if (least_.value > 0 || options_.accept_folded) return;
      auto const folded = least_jacobian_on(parts_, {end.data}, false);
      if (folded.value > 0) return;
      throw NotTaken{detail::message(
          {Scheme::name, ": the step to time ", parts_.state.time + h,
           " s folds the body: det F comes to ", folded.value, " in ", folded.element, " element ",
           folded.number,
           ", perhaps between the points of its quadrature; take smaller steps, more "
           "points or a finer mesh there, or accept it by accept_folded"})};
    }
    /// What the step has beyond an extrapolation, times what of that is an error, m, into arrays.trial.
    Field find_step_error(double h) {
      auto& own = balance_.arrays();
      auto const beyond = balance_.field(own.trial);
      double const share = rule_.error_share;
      detail::set_sum(parts_.backend, parts_.layout.nodes, beyond,
                      balance_.scaled(share, balance_.field(own.increment)),
                      balance_.scaled(-share * h, parts_.v()),
                      balance_.scaled(Scheme::order > 1 ? -share * h * h / 2 : 0,
                                      balance_.field(parts_.state.implicit.a)));
      detail::keep_unknowns(parts_, beyond);
      return beyond;
    }
    double largest(Field field) const {
      return parts_.backend.maximum(parts_.layout.nodes, detail::LargestAt<T, dim>{{field.data}});
    }
    /// The largest error of a displacement, m.
    double step_error(double h) { return largest(find_step_error(h)); }
    /// To the end of the step, which is not yet the body's state.
    void carry_errors(double h) {
      auto& kept = parts_.state.implicit;
      errors_.find_residual(rule_);
      if (balance_.norm(balance_.arrays().residual) > 0) {
        if (!solve(1e-2, h)) kept.error = std::numeric_limits<double>::infinity();
      } else {
        auto const nothing = balance_.field(balance_.arrays().solution);
        detail::set_sum(parts_.backend, parts_.layout.nodes, nothing, balance_.scaled(0, nothing));
      }
      double const off = errors_.go_on(rule_, Scheme::looks_back, find_step_error(h));
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
      Index const n = parts_.layout.nodes;
      auto const d = balance_.field(own.increment), speed = balance_.field(own.speed),
                 a = balance_.field(own.acceleration);
      balance_.set_end(speed, rule_.velocity);
      balance_.set_end(a, rule_.acceleration);
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
      report_.reached = std::max(report_.reached, reached_);
      if (!(least_.value >= report_.least_J.value)) report_.least_J = least_;
    }

    Implicit& integrator_;
    ImplicitOptions const& options_;
    TheBody& body_;
    Parts& parts_;
    detail::Balance<Parts> balance_;
    detail::CarriedErrors<Parts> errors_;
    detail::LinearSolver<dim>& linear_;
    LinearReport before_;
    detail::Preconditioning<Parts> preconditioning_;
    ImplicitReport& report_;
    double tolerance_;
    bool carries_;  // errors
    std::optional<detail::BalanceInDouble<TheBody>> in_double_;
    std::optional<detail::AssembledSteps<TheBody>> assembled_;
    bool may_assemble_ = false;  // where steps without a matrix find no way
    StepRule rule_{};
    LeastJacobian least_{};
    std::string why_not_;    // the linear system of a step was not solved; empty where it was
    double reached_ = 0;     // of the present step
    double start_work_ = 0;  // J: of the residual along the solution, where that begins
  };

  Scheme scheme_;
  ImplicitOptions options_;
  detail::LinearSolver<2> plane_;  // of bodies in two and three dimensions
  detail::LinearSolver<3> solid_;
};

}  // namespace pliant

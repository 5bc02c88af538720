#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include <pliant/solver/least_jacobian.hpp>
#include <pliant/solver/linear/linear_solver.hpp>
#include <pliant/solver/linear/same_registers.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant {

/// How follow_path goes along equilibria.
struct PathOptions {
  double first = 0.1;  // share of the loads that the first step would take if the body were linear
  double longest = 4;  // arcs, in lengths of the first
  int max_points = 500;                         // and no more
  int max_iterations = 16;                      // of Newton's method, per point
  double tolerance = 1e-9;                      // of residuals, relative to the forces; below 1
  MassMatrix gravity = MassMatrix::consistent;  // on which masses it acts
  bool accept_folded = false;                   // points where the body is folded somewhere
};

/// A point of a path of equilibria.
struct PathPoint {
  double share = 0;     // of gravity, loads, pressures and motions; it may fall, and be negative
  double energy = 0;    // strain energy, J
  double residual = 0;  // N
  int iterations = 0;   // from the point before
  bool stable =
      true;  // whether the stiffness is positive definite; not told where forces have no potential
};

/// Why follow_path ended: all of the loads act; the visitor did not want more; as many points as were allowed; no
/// further point was found.
enum class PathEnd { reached, stopped, most_points, lost };

struct PathReport {
  PathEnd end = PathEnd::reached;
  int points = 0;
  PathPoint last{};
};

namespace detail {

/// See follow_path.
template <DeformableBody TheBody>
class EquilibriumPath {
  using Vector = Eigen::VectorXd;

 public:
  EquilibriumPath(TheBody const& body, PathOptions const& options)
      : body_(body),
        options_(options),
        tasks_(body.parts().backend),
        problem_(body, options.gravity),
        conservative_(is_conservative(body)),
        linear_("follow_path", LinearMethod::direct),
        from_(StaticProblem<TheBody>::flat(
            body.parts().layout.in_user_order(place_before_drives(body.parts())))),
        way_(Vector::Zero(from_.size())),
        u_(from_) {
    Vector to = from_;
    problem_.prescribe(to, body.time());
    problem_.copy_prescribed(to - from_, way_);
    balance_ = force_at(u_, 0);
    problem_.unknowns.keep(balance_);
    growth_ = problem_.external + balance_;
    set_tangent();
    arc_ = options.first * tangent_.norm();
    first_arc_ = arc_;
    if (!std::isfinite(arc_))
      throw Error(
          "follow_path: energy or forces are not finite where the path starts: an element is "
          "folded there");
    if (!(arc_ > 0))
      throw Error("follow_path: no load, pressure, weight or motion grows; set one before");
  }

  Vector const& displacements() const { return u_; }
  PathPoint const& point() const { return point_; }
  bool has_ended() const { return point_.share == 1; }

  /// To the next point; false, and nothing changes, where none is found.
  bool go_on() {
    for (int shortened = 0; shortened < 12; ++shortened, arc_ /= 2)
      if (find_next()) return true;
    return false;
  }

 private:
  /// Forces of elements, pressures and other terms, N.
  Vector force_at(Vector const& u, double share) {
    assemble_into(sum_, body_.parts(), u, Assemble::energy_and_force,
                  std::numeric_limits<double>::infinity(), share);
    return sum_.force;
  }
  void assemble_stiffness(Vector const& u, double share) {
    assemble_into(sum_, body_.parts(), u, Assemble::stiffness,
                  std::numeric_limits<double>::infinity(), share);
  }
  Vector solve(Vector right) {
    problem_.unknowns.keep(right);
    linear_.begin_anew();  // factors of another matrix do not serve for one that may be indefinite
    return linear_.solve(tasks_,
                         {sum_.stiffness, problem_.unknowns, body_.mesh().nodes, conservative_},
                         right, 1e-12);
  }
  /// ∂(residual)/∂(share) at displacements whose stiffness is assembled.
  Vector growth_at(Vector const& u) {
    Vector growth = growth_, pushed;
    multiply(tasks_, sum_.stiffness, way_, pushed);
    growth -= pushed;
    if (!body_.parts().pressures.empty()) growth += force_at(u, 1) - force_at(u, 0);
    return growth;
  }
  /// Of the present point: du/d(share), and whether the point is stable.
  void set_tangent() {
    assemble_stiffness(u_, point_.share);
    tangent_ = solve(growth_at(u_));
    point_.stable = !(conservative_ && linear_.indefinite());
  }
  /// Displacements at a share of the motions, where unknowns have gone by `du`.
  Vector place(Vector const& du, double share) const {
    Vector u = u_;
    problem_.copy_prescribed(from_ + share * way_, u);
    problem_.add(u, du, 1);
    return u;
  }

  /// A point one arc from the present one, by Newton's method on balance and on the length of the arc together; or the
  /// one that bears all, where that is nearer or `ends` says so.
  bool find_next(bool ends = false) {
    double const direction = last_.size() == 0 || tangent_.dot(last_) >= 0 ? 1 : -1;
    double grown = direction * arc_ / tangent_.norm();  // of the share
    ends = ends || point_.share + grown >= 1;
    if (ends) grown = 1 - point_.share;
    Vector du = grown * tangent_;
    Vector const way = du;
    for (int iteration = 0; iteration <= options_.max_iterations; ++iteration) {
      double const share = ends ? 1 : point_.share + grown;
      Vector const u = place(du, share);
      Vector const force = force_at(u, share);
      double const energy = sum_.energy;
      Vector const load = share * problem_.external - (1 - share) * balance_;
      Vector residual = force + load;
      problem_.unknowns.keep(residual);
      double const size = residual.norm(), scale = std::max(load.norm(), force.norm());
      if (!std::isfinite(size) || !std::isfinite(energy)) return false;
      if (size <= options_.tolerance * scale && share > 1) return find_next(true);
      if (size <= options_.tolerance * scale)
        return accept(u, du, {share, energy, size, iteration, true}, ends);
      try {
        assemble_stiffness(u, share);
        Vector const back = solve(residual);
        if (ends) {
          du += back;
          continue;
        }
        Vector const along = solve(growth_at(u));
        auto const change = back_to_arc(du, du + back, along, way);
        if (!change) return false;
        grown += *change;
        du += back + *change * along;
      } catch (Error const&) {  // a singular matrix: a limit point was hit
        return false;
      }
    }
    return false;
  }
  /// The change of the share that makes |moved + change · along| as long as the arc, the one that leads on from
  /// `du` (Crisfield, Computers & Structures 13 (1981) 55); none where no change does.
  std::optional<double> back_to_arc(Vector const& du, Vector const& moved, Vector const& along,
                                    Vector const& way) const {
    double const a = along.squaredNorm(), b = along.dot(moved),
                 c = moved.squaredNorm() - way.squaredNorm();
    double const root = b * b - a * c;
    if (!(root >= 0)) return std::nullopt;
    double const one = (-b + std::sqrt(root)) / a, other = (-b - std::sqrt(root)) / a;
    return (moved + one * along).dot(du) >= (moved + other * along).dot(du) ? one : other;
  }
  bool accept(Vector const& u, Vector const& du, PathPoint const& point, bool ends) {
    // An end so far away is on another branch.
    if (ends && du.norm() > 2 * arc_) return false;
    if (!options_.accept_folded && !(least_jacobian_at(body_.parts(), u, false).value > 0))
      return false;
    auto const before = std::pair{u_, point_};
    u_ = u;
    point_ = point;
    try {
      set_tangent();
    } catch (Error const&) {  // exactly at a limit point: another arc does not end there
      std::tie(u_, point_) = before;
      assemble_stiffness(u_, point_.share);
      return false;
    }
    last_ = du;
    double const change = std::sqrt((few_iterations + 1.0) / (point.iterations + 1.0));
    arc_ = std::min(arc_ * std::clamp(change, 0.5, 1.5), options_.longest * first_arc_);
    return true;
  }

  static constexpr int few_iterations = 4;  // per point, at which arcs stay as long as they are
  TheBody const& body_;
  PathOptions options_;
  HostTasks tasks_;
  StaticProblem<TheBody> problem_;
  bool conservative_;
  LinearSolver<TheBody::dim> linear_;
  AssembledBlocks<TheBody::dim> sum_;
  Vector from_, way_;          // where the path starts, and how far nodes are driven, m
  Vector balance_, growth_;    // N: what is in balance there; what grows with the share
  Vector u_, last_, tangent_;  // m: the present point, the way to it, and du/d(share)
  PathPoint point_;
  double arc_ = 0, first_arc_ = 0;  // m
};

}  // namespace detail

/// Follows equilibria from where the body is, as gravity, loads, pressures and motions grow from nothing to all that they
/// are, through limit points, where shares of them fall and the body would snap (arc lengths: Riks, International Journal of
/// Solids and Structures 15 (1979) 529; Crisfield, Computers & Structures 13 (1981) 55). At each point the body has
/// its displacements, and visit(PathPoint) tells whether to go on. Ends at the first point that bears all, or as
/// PathReport::end tells, with the body at the last point; velocities are left alone. The user's own force terms act in
/// full. Throws Error, with the body as it was, where the path cannot start.
template <DeformableBody TheBody, class Visit>
  requires std::is_invocable_r_v<bool, Visit&, PathPoint const&>
PathReport follow_path(TheBody& body, PathOptions const& options, Visit&& visit) {
  detail::check_registers();
  if (!(options.first > 0) || !(options.longest > 0) || options.max_points < 1 ||
      options.max_iterations < 1 || !(options.tolerance > 0 && options.tolerance < 1))
    throw Error("follow_path: first ", options.first, ", longest ", options.longest,
                ", max_points ", options.max_points, ", max_iterations ", options.max_iterations,
                ", tolerance ", options.tolerance,
                "; give numbers above 0, and a tolerance below 1");
  detail::EquilibriumPath<TheBody> path(body, options);
  PathReport report;
  for (;;) {
    if (!path.go_on()) {
      report.end = PathEnd::lost;
      break;
    }
    body.set_displacements(detail::StaticProblem<TheBody>::per_node(path.displacements()));
    body.parts().before_drives = {};
    report.last = path.point();
    ++report.points;
    bool const goes_on = visit(path.point());
    if (path.has_ended()) break;
    if (!goes_on || report.points == options.max_points) {
      report.end = goes_on ? PathEnd::most_points : PathEnd::stopped;
      break;
    }
  }
  if constexpr (TheBody::has_internal_variables)
    change_by_hand(body.parts(), [&] { equilibrate(body.parts()); });
  return report;
}

}  // namespace pliant

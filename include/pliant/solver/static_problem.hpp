#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <pliant/body/loads.hpp>
#include <pliant/mesh/loads.hpp>
#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/linear/unknowns.hpp>

namespace pliant::detail {

/// A body's unknowns, loads and prescribed displacements as vectors over (node, direction) in the user's order.
template <DeformableBody TheBody>
class StaticProblem {
 public:
  static constexpr int dim = TheBody::dim;

  /// `gravity`: on which masses it acts.
  explicit StaticProblem(TheBody const& body, MassMatrix gravity = MassMatrix::consistent)
      : unknowns(fixed_entries(body)), body_(body) {
    external = weight(gravity) + nodal_load();
  }

  Unknowns const unknowns;   // what nothing holds, drives or interpolates
  Eigen::VectorXd external;  // gravity and loads, N; those of slaves with their masters

  Eigen::Index size() const { return unknowns.size(); }

  /// The present displacement.
  Eigen::VectorXd start() const { return flat(body_.displacements()); }
  /// Puts driven nodes where their motions are at a time, s. Throws Error where that is not finite.
  void prescribe(Eigen::VectorXd& u, double time) const {
    for (auto const& condition : body_.state().prescribed->conditions) {
      if (!condition.motion) continue;
      for (Index node : condition.nodes) {
        auto const to = position_at<dim>(
            condition.motion, body_.mesh().nodes[at(node)], [&] { return node; }, time);
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) u[dim * node + k] = to[at(k)];
      }
    }
    interpolate_slaves(body_, u);
  }
  /// Copies the entries that nodes are driven to; slaves follow.
  void copy_prescribed(Eigen::VectorXd const& from, Eigen::VectorXd& to) const {
    for (auto const& condition : body_.state().prescribed->conditions) {
      if (!condition.motion) continue;
      for (Index node : condition.nodes)
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) to[dim * node + k] = from[dim * node + k];
    }
    interpolate_slaves(body_, to);
  }
  void add(Eigen::VectorXd& u, Eigen::VectorXd const& change, double factor) const {
    for (Eigen::Index i = 0; i < u.size(); ++i)
      if (!unknowns.fixed()[at(i)]) u[i] += factor * change[i];
    interpolate_slaves(body_, u);
  }

  /// Which entries are held, driven or of slaves, or of nodes of no element.
  static std::vector<bool> fixed_entries(TheBody const& body) {
    std::vector<bool> fixed(static_cast<std::size_t>(dim * body.nodes()), false);
    for (auto const& condition : body.state().prescribed->conditions)
      for (Index node : condition.nodes)
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) fixed[at(dim * node + k)] = true;
    for (Index i = 0; i < body.nodes(); ++i)
      if (!(body.parts().layout.mass_list()[at(i)] > 0))  // slaves, and nodes of no element
        for (int k = 0; k < dim; ++k) fixed[at(dim * i + k)] = true;
    return fixed;
  }

  /// Values per node as one vector, and back.
  static Eigen::VectorXd flat(std::vector<Point<dim>> const& points) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(dim * points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        values[static_cast<Eigen::Index>(dim * i + k)] = points[i][k];
    return values;
  }
  static std::vector<Point<dim>> per_node(Eigen::VectorXd const& values) {
    std::vector<Point<dim>> points(static_cast<std::size_t>(values.size()) / dim);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        points[i][k] = values[static_cast<Eigen::Index>(dim * i + k)];
    return points;
  }

 private:
  template <class I>
  static std::size_t at(I i) {
    return static_cast<std::size_t>(i);
  }
  void hand_to_masters(Eigen::VectorXd& f) const {
    body_.state().topology->interpolation.apply_transpose(
        [&](Index i, int k) -> double& { return f[Eigen::Index{dim} * i + k]; }, dim);
  }
  Eigen::VectorXd weight(MassMatrix kind) const {
    Point<dim> force = body_.state().gravity;
    if (force == Point<dim>{}) return Eigen::VectorXd::Zero(size());
    Eigen::VectorXd f(size());
    if (kind == MassMatrix::lumped) {
      for (Index i = 0; i < body_.nodes(); ++i)
        for (int k = 0; k < dim; ++k)
          f[dim * i + k] = body_.parts().layout.mass_list()[at(i)] * force[at(k)];
    } else {
      for (double& x : force) x *= body_.material().density;
      f = flat(body_loads(body_.mesh(), force));
      hand_to_masters(f);
    }
    return f;
  }
  Eigen::VectorXd nodal_load() const {
    auto const loads = nodal_loads(body_);
    if (loads.empty()) return Eigen::VectorXd::Zero(size());
    Eigen::VectorXd f = flat(loads);
    hand_to_masters(f);
    return f;
  }

  TheBody const& body_;
};

/// Whether all forces have a potential: then the stiffness is symmetric.
template <DeformableBody TheBody>
bool is_conservative(TheBody const& body) {
  bool all = body.parts().pressures.empty();
  for (auto const& term : body.parts().terms) all = all && term->has_energy();
  return all;
}

}  // namespace pliant::detail

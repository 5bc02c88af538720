#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <pliant/body/loads.hpp>
#include <pliant/mesh/loads.hpp>
#include <pliant/solver/assemble_mass.hpp>

namespace pliant::detail {

/// A body's unknowns, loads and prescribed displacements as vectors over (node, direction) in the user's
/// order; the unknowns among them are those that nothing holds, drives or interpolates.
template <DeformableBody TheBody>
class StaticProblem {
 public:
  static constexpr int dim = TheBody::dim;

  /// `gravity`: on which masses it acts.
  explicit StaticProblem(TheBody const& body, MassMatrix gravity = MassMatrix::consistent)
      : body_(body), unknown_(static_cast<std::size_t>(dim * body.nodes()), -1) {
    std::vector<bool> fixed(unknown_.size(), false);
    for (auto const& condition : body.state().prescribed->conditions)
      for (Index node : condition.nodes)
        for (int k = 0; k < dim; ++k)
          if (condition.directions >> k & 1) fixed[at(dim * node + k)] = true;
    for (Index i = 0; i < body.nodes(); ++i)
      if (!(body.parts().layout.mass_list[at(i)] > 0))  // slaves, and nodes of no element
        for (int k = 0; k < dim; ++k) fixed[at(dim * i + k)] = true;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (!fixed[i]) unknown_[i] = unknowns_++;
    external = weight(gravity) + nodal_load();
  }

  Eigen::VectorXd external;  // gravity and loads, N; those of slaves with their masters

  Index unknowns() const { return unknowns_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(unknown_.size()); }

  /// The present displacement.
  Eigen::VectorXd start() const { return flat(body_.displacements()); }
  /// Puts driven nodes where their motions are at a time, s. Throws Error where that is not finite.
  void prescribe(Eigen::VectorXd& u, double time) const {
    for (auto const& condition : body_.state().prescribed->conditions) {
      if (!condition.motion) continue;
      for (Index node : condition.nodes) {
        auto const to =
            position_at<dim>(condition.motion, body_.mesh().nodes[at(node)], node, time);
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
  /// Sets all but the unknowns to zero.
  void keep_unknowns(Eigen::VectorXd& full) const {
    for (std::size_t i = 0; i < unknown_.size(); ++i)
      if (unknown_[i] < 0) full[static_cast<Eigen::Index>(i)] = 0;
  }
  void add(Eigen::VectorXd& u, Eigen::VectorXd const& reduced, double factor) const {
    for (std::size_t i = 0; i < unknown_.size(); ++i)
      if (unknown_[i] >= 0) u[static_cast<Eigen::Index>(i)] += factor * reduced[unknown_[i]];
    interpolate_slaves(body_, u);
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
          f[dim * i + k] = body_.parts().layout.mass_list[at(i)] * force[at(k)];
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
  std::vector<Index> unknown_;
  Index unknowns_ = 0;
};

/// Whether all forces have a potential: then the stiffness is symmetric.
template <DeformableBody TheBody>
bool is_conservative(TheBody const& body) {
  bool all = body.parts().pressures.empty();
  for (auto const& term : body.parts().terms) all = all && term->has_energy();
  return all;
}

}  // namespace pliant::detail

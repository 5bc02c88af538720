#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/node_rows.hpp>
#include <pliant/body/when_asked.hpp>
#include <pliant/constraint/condition.hpp>

namespace pliant {

namespace detail {

/// Puts the nodes of a list at prescribed displacements and velocities: one for all, or a row for each.
template <class T, int Dim>
struct Prescribe {
  NodeField<T, Dim> u, v;
  Index const* nodes;
  DirectionMask directions;
  Vector<T, Dim> displacement, velocity;
  T const* rows;  // (listed nodes, 2 Dim): displacement and velocity; null: the same for all

  PLIANT_HOST_DEVICE void operator()(Index n) const {
    auto const row = std::ptrdiff_t{2 * Dim} * n;
    for (int k = 0; k < Dim; ++k)
      if (directions >> k & 1) {
        u(nodes[n], k) = rows ? rows[row + k] : displacement[k];
        v(nodes[n], k) = rows ? rows[row + Dim + k] : velocity[k];
      }
  }
};

/// Copies the values of the nodes of a list in some directions.
template <class T, int Dim>
struct CopyListed {
  NodeField<T const, Dim> from;
  NodeField<T, Dim> to;
  Index const* nodes;
  DirectionMask directions;

  PLIANT_HOST_DEVICE void operator()(Index n) const {
    for (int k = 0; k < Dim; ++k)
      if (directions >> k & 1) to(nodes[n], k) = from(nodes[n], k);
  }
};

/// The work of a condition on the nodes that it drives, J, around the present time: the forces F that pull there
/// are overcome along the half steps before and behind it, and the nodes gain kinetic energy,
/// −F·(lag v₋ + kick v₊) + m (v₊² − v₋²)/2.
template <class T, int Dim>
struct MotionWork {
  NodeField<T const, Dim> v, f;
  T const* mass;
  T const* load;  // (nodes, 4); may be null
  Vector<T, Dim> gravity;
  Index const* nodes;
  DirectionMask directions;
  Vector<T, Dim> velocity;
  T const* rows;
  double lag, kick;  // s
  bool drifts;       // whether a step begins

  PLIANT_HOST_DEVICE double operator()(Index n) const {
    Index const i = nodes[n];
    auto const row = std::ptrdiff_t{2 * Dim} * n;
    double work = 0;
    for (int k = 0; k < Dim; ++k) {
      if (!(directions >> k & 1)) continue;
      T force = f(i, k) + mass[i] * gravity[k];
      if (load) force += NodeField<T const, Dim>{load}(i, k);
      double const before = static_cast<double>(v(i, k));
      double const after = static_cast<double>(rows ? rows[row + Dim + k] : velocity[k]);
      work -= static_cast<double>(force) * (lag * before + (drifts ? kick * after : 0.0));
      if (drifts) work += static_cast<double>(mass[i]) * (after * after - before * before) / 2;
    }
    return zero_if_not_finite(work);
  }
};

/// Where a motion wants a node. Throws Error where that is not finite in the precision T. `node`(): the user's number.
template <int Dim, class T = double, std::invocable NodeNumber>
Point<Dim> position_at(Motion<Dim> const& motion, Point<Dim> const& place, NodeNumber const& node,
                       double time) {
  Point<Dim> const u = motion(place, time);
  for (double x : u)
    if (!std::isfinite(static_cast<T>(x)))
      throw Error("body.drive: the motion of node ", node(), " is ", u, " at time ", time,
                  " s; it must be finite", std::isfinite(x) ? " in single precision" : "");
  return u;
}

}  // namespace detail

/// The nodes that one condition drives, in a backend's memory.
template <Backend B, int Dim>
class DrivenNodes {
  using T = typename B::scalar;
  using Field = NodeField<T, Dim>;

 public:
  /// `nodes`: their rows in fields. `places`: where they are at rest, m, in the same order, for a motion that depends on it;
  /// else none. `of_rows`: the nodes by their rows, for errors.
  DrivenNodes(B const& backend, Motion<Dim> motion, DirectionMask directions,
              typename B::template Array<Index> nodes, std::vector<Point<Dim>> places,
              WhenAsked<NodeRows> of_rows)
      : motion_(std::move(motion)),
        directions_(directions),
        nodes_(std::move(nodes)),
        places_(std::move(places)),
        of_rows_(std::move(of_rows)) {
    if (motion_.is_uniform()) return;
    rows_ = zeros<T>(backend, 2 * Dim * nodes_.size());
    host_rows_.resize(2 * Dim * nodes_.size());
  }

  /// Their rows in fields, in the backend's memory.
  [[nodiscard]] typename B::template Array<Index> const& rows() const { return nodes_; }
  /// What the motion asks for at a time, reached over `over` seconds. Throws Error where it is not finite,
  /// before anything changes; place() then puts the nodes there.
  void ask(double time, double over) {
    auto const ask_one = [&](Point<Dim> const& place, std::size_t n, auto& displacement,
                             auto& velocity) {
      auto const node = [&] { return number_of(n); };
      Point<Dim> const to = detail::position_at<Dim, T>(motion_, place, node, time);
      Point<Dim> const from =
          over > 0 ? detail::position_at<Dim, T>(motion_, place, node, time - over) : to;
      for (std::size_t k = 0; k < Dim; ++k) {
        displacement[static_cast<int>(k)] = static_cast<T>(to[k]);
        T const speed = over > 0 ? static_cast<T>((to[k] - from[k]) / over) : T(0);
        if (!std::isfinite(speed))
          throw Error("body.drive: the motion of node ", node(), " goes from ", from, " to ", to,
                      " within ", over, " s; this speed is not finite");
        velocity[static_cast<int>(k)] = speed;
      }
    };
    if (nodes_.size() == 0) return;
    if (motion_.is_uniform()) {
      ask_one({}, 0, displacement_, velocity_);
      return;
    }
    for (std::size_t n = 0; n < places_.size(); ++n) {
      T* const row = host_rows_.data() + 2 * Dim * n;
      T* const speed = row + Dim;
      ask_one(places_[n], n, row, speed);
    }
    rows_.upload(host_rows_);
  }
  /// Adds the condition's work to *to, J; see MotionWork. Before the nodes are placed.
  void add_work(B const& backend, NodeField<T const, Dim> v, NodeField<T const, Dim> f,
                T const* mass, Vector<T, Dim> const& gravity, T const* load, double lag,
                double kick, bool drifts, double* to) const {
    backend.add_sum(
        static_cast<Index>(nodes_.size()),
        detail::MotionWork<T, Dim>{v, f, mass, load, gravity, nodes_.data(), directions_, velocity_,
                                   rows_.size() > 0 ? rows_.data() : nullptr, lag, kick, drifts},
        to);
  }
  /// Copies one field to another where the condition drives nodes.
  void copy(B const& backend, NodeField<T const, Dim> from, Field to) const {
    backend.for_each(static_cast<Index>(nodes_.size()),
                     detail::CopyListed<T, Dim>{from, to, nodes_.data(), directions_});
  }
  void place(B const& backend, Field u, Field v) const {
    backend.for_each(
        static_cast<Index>(nodes_.size()),
        detail::Prescribe<T, Dim>{u, v, nodes_.data(), directions_, displacement_, velocity_,
                                  rows_.size() > 0 ? rows_.data() : nullptr});
  }

 private:
  [[nodiscard]] Index number_of(std::size_t n) const {
    auto const row = static_cast<std::size_t>(download<Index>(nodes_)[n]);
    return of_rows_->node[row];
  }

  Motion<Dim> motion_;
  DirectionMask directions_;
  typename B::template Array<Index> nodes_;
  std::vector<Point<Dim>> places_;  // at rest, of motions that depend on it
  WhenAsked<NodeRows> of_rows_;
  std::vector<T> host_rows_;
  typename B::template Array<T> rows_;
  Vector<T, Dim> displacement_{}, velocity_{};
};

}  // namespace pliant

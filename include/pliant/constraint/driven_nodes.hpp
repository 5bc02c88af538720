#pragma once

#include <cmath>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/value_at.hpp>
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
    T const* const row = rows + 2 * Dim * static_cast<std::ptrdiff_t>(n);
    for (int k = 0; k < Dim; ++k)
      if (directions >> k & 1) {
        u(nodes[n], k) = rows ? row[k] : displacement[k];
        v(nodes[n], k) = rows ? row[Dim + k] : velocity[k];
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
    T const* const row = rows + 2 * Dim * static_cast<std::ptrdiff_t>(n);
    double work = 0;
    for (int k = 0; k < Dim; ++k) {
      if (!(directions >> k & 1)) continue;
      T force = f(i, k) + mass[i] * gravity[k];
      if (load) force += NodeField<T const, Dim>{load}(i, k);
      double const before = static_cast<double>(v(i, k));
      double const after = static_cast<double>(rows ? row[Dim + k] : velocity[k]);
      work -= static_cast<double>(force) * (lag * before + (drifts ? kick * after : 0.0));
      if (drifts) work += static_cast<double>(mass[i]) * (after * after - before * before) / 2;
    }
    return zero_if_not_finite(work);
  }
};

/// Where a motion wants a node. Throws Error where that is not finite in the precision T.
template <int Dim, class T = double>
Point<Dim> position_at(Motion<Dim> const& motion, Point<Dim> const& place, Index node,
                       double time) {
  Point<Dim> const u = motion(place, time);
  for (double x : u)
    if (!std::isfinite(static_cast<T>(x)))
      throw Error("body.drive: the motion of node ", node, " is ", u, " at time ", time,
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
  /// `internal`: the internal numbers of the condition's nodes; place_of(node): where one rests.
  template <std::invocable<Index> PlaceOf>
  DrivenNodes(B const& backend, Condition<Dim> const& condition, std::vector<Index> const& internal,
              PlaceOf const& place_of)
      : condition_(condition), nodes_(upload(backend, internal)) {
    if (condition.motion.is_uniform()) return;
    for (Index node : condition.nodes) places_.push_back(place_of(node));
    rows_ = zeros<T>(backend, 2 * Dim * internal.size());
    host_rows_.resize(2 * Dim * internal.size());
  }

  /// What the motion asks for at a time, reached over `over` seconds. Throws Error where it is not finite,
  /// before anything changes; place() then puts the nodes there.
  void ask(double time, double over) {
    auto const ask_one = [&](Point<Dim> const& place, Index node, auto& displacement,
                             auto& velocity) {
      Point<Dim> const to = detail::position_at<Dim, T>(condition_.motion, place, node, time);
      Point<Dim> const from =
          over > 0 ? detail::position_at<Dim, T>(condition_.motion, place, node, time - over) : to;
      for (std::size_t k = 0; k < Dim; ++k) {
        displacement[static_cast<int>(k)] = static_cast<T>(to[k]);
        T const speed = over > 0 ? static_cast<T>((to[k] - from[k]) / over) : T(0);
        if (!std::isfinite(speed))
          throw Error("body.drive: the motion of node ", node, " goes from ", from, " to ", to,
                      " within ", over, " s; this speed is not finite");
        velocity[static_cast<int>(k)] = speed;
      }
    };
    if (condition_.nodes.empty()) return;
    if (condition_.motion.is_uniform()) {
      ask_one({}, condition_.nodes[0], displacement_, velocity_);
      return;
    }
    for (std::size_t n = 0; n < places_.size(); ++n) {
      T* const row = host_rows_.data() + 2 * Dim * n;
      T* const speed = row + Dim;
      ask_one(places_[n], condition_.nodes[n], row, speed);
    }
    rows_.upload(host_rows_);
  }
  /// Adds the condition's work to *to, J; see MotionWork. Before the nodes are placed.
  void add_work(B const& backend, NodeField<T const, Dim> v, NodeField<T const, Dim> f,
                T const* mass, Vector<T, Dim> const& gravity, T const* load, double lag,
                double kick, bool drifts, double* to) const {
    backend.add_sum(static_cast<Index>(nodes_.size()),
                    detail::MotionWork<T, Dim>{
                        v, f, mass, load, gravity, nodes_.data(), condition_.directions, velocity_,
                        rows_.size() > 0 ? rows_.data() : nullptr, lag, kick, drifts},
                    to);
  }
  /// Copies one field to another where the condition drives nodes.
  void copy(B const& backend, NodeField<T const, Dim> from, Field to) const {
    backend.for_each(static_cast<Index>(nodes_.size()),
                     detail::CopyListed<T, Dim>{from, to, nodes_.data(), condition_.directions});
  }
  void place(B const& backend, Field u, Field v) const {
    backend.for_each(
        static_cast<Index>(nodes_.size()),
        detail::Prescribe<T, Dim>{u, v, nodes_.data(), condition_.directions, displacement_,
                                  velocity_, rows_.size() > 0 ? rows_.data() : nullptr});
  }

 private:
  Condition<Dim> condition_;
  typename B::template Array<Index> nodes_;
  std::vector<Point<Dim>> places_;  // at rest, of motions that depend on it
  std::vector<T> host_rows_;
  typename B::template Array<T> rows_;
  Vector<T, Dim> displacement_{}, velocity_{};
};

}  // namespace pliant

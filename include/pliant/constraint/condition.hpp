#pragma once

#include <concepts>
#include <functional>
#include <string>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant {

/// Bits of the directions in which a node does not move freely.
using DirectionMask = std::uint8_t;
/// Bits 0 to Dim − 1.
template <int Dim>
inline constexpr DirectionMask all_directions = (1u << Dim) - 1;

/// A prescribed displacement, m, as a function of the place at rest (m) and of time (s), or of time alone.
template <int Dim>
class Motion {
 public:
  Motion() = default;
  template <class F>
    requires(!std::same_as<std::remove_cvref_t<F>, Motion>) &&
            std::is_invocable_r_v<Point<Dim>, F&, double>
  Motion(F f) : of_time_(std::move(f)) {}
  template <class F>
    requires(!std::same_as<std::remove_cvref_t<F>, Motion>) &&
            std::is_invocable_r_v<Point<Dim>, F&, Point<Dim> const&, double>
  Motion(F f) : of_place_(std::move(f)) {}

  explicit operator bool() const { return of_time_ || of_place_; }
  /// Whether all places move alike.
  bool is_uniform() const { return static_cast<bool>(of_time_); }
  Point<Dim> operator()(Point<Dim> const& place, double time) const {
    return of_time_ ? of_time_(time) : of_place_(place, time);
  }

 private:
  std::function<Point<Dim>(double)> of_time_;
  std::function<Point<Dim>(Point<Dim> const&, double)> of_place_;
};

/// Names a condition or a pressure of one body for as long as it acts.
struct Handle {
  Index id = -1;
  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("handle", r.id...);
  }
  friend bool operator==(Handle, Handle) = default;
};

/// What a body prescribes at facets or at nodes. A condition on facets is inherited by their parts
/// when the mesh is refined; one on nodes stays with these nodes.
template <int Dim>
struct Condition {
  Handle handle;
  std::vector<Facet<Dim>> facets;
  std::vector<Index> nodes;  // the user's numbers, those of the facets included
  DirectionMask directions;
  std::string name;    // of the motion; empty: held where it is
  Motion<Dim> motion;  // empty: held where it is

  /// All but the motion, which is a function: its name stands for it.
  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("handle", r.handle...);
    visit("facets", r.facets...);
    visit("nodes", r.nodes...);
    visit("directions", r.directions...);
    visit("name", r.name...);
  }
};

/// A pressure on facets that follows the surface.
template <int Dim>
struct Pressure {
  Handle handle;
  std::vector<Facet<Dim>> facets;
  double pascals;  // positive: against the outward normal

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("handle", r.handle...);
    visit("facets", r.facets...);
    visit("pascals", r.pascals...);
  }
};

/// All that a body prescribes on its boundary. Never changed: a new condition makes another.
template <int Dim>
struct Prescribed {
  std::vector<Condition<Dim>> conditions;
  std::vector<Pressure<Dim>> pressures;
  Index next_id = 0;  // of handles

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("conditions", r.conditions...);
    visit("pressures", r.pressures...);
    visit("next handle", r.next_id...);
  }
};

}  // namespace pliant

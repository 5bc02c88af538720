#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/backend/carry_rows.hpp>
#include <pliant/body/group.hpp>
#include <pliant/body/held_sides_on.hpp>
#include <pliant/constraint/driven_nodes.hpp>
#include <pliant/force/pressure.hpp>

// What drives nodes of a body, and presses its facets, while its mesh is changed in a backend's memory.
namespace pliant {

namespace detail {

/// The faces that the sides of an element are, each kind once.
template <Element E>
constexpr auto faces_of() {
  constexpr bool is_linear = E::degree == 1;
  if constexpr (E::dim == 2)
    return TypeList<std::conditional_t<is_linear, Line2, Line3>>{};
  else if constexpr (SimplexCell<typename E::cell>)
    return TypeList<std::conditional_t<is_linear, Tri3, Tri6>>{};
  else if constexpr (TensorCell<typename E::cell>)
    return TypeList<std::conditional_t<
        is_linear, Quad4, std::conditional_t<E::lumping == Lumping::nodal, Quad9, Quad8>>>{};
  else
    return TypeList<Tri3, Quad4>{};
}

}  // namespace detail

/// The motions and pressures of a body, with the sets of HeldSidesOn on which they act.
template <int Dim, Backend B>
class ActingOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// row_of(the user's number): the row of a node.
  template <class RowOf>
  void set(B const& backend, Prescribed<Dim> const& prescribed, RowOf const& row_of) {
    driven_.clear();
    pressed_.clear();
    std::size_t sets = 0;
    for (auto const& condition : prescribed.conditions) {
      bool const of_facets = !condition.facets.empty();
      if (condition.motion) {
        std::vector<Index> rows;
        if (!of_facets)
          for (Index const node : condition.nodes) rows.push_back(row_of(node));
        driven_.push_back(
            {condition.motion, condition.directions, of_facets, sets, upload(backend, rows)});
      }
      sets += of_facets;
    }
    for (auto const& pressure : prescribed.pressures)
      pressed_.push_back({pressure.pascals, sets++});
  }

  /// Makes the driven nodes of parts behind a change, whose layout has the rows of nodes. `on`: the TopologyOn behind it.
  template <class Parts, class On>
  void drive(Parts& parts, On const& on) const {
    auto const& backend = parts.backend;
    for (auto const& own : driven_) {
      auto rows = own.is_of_facets
                      ? on.held.nodes_of_set(backend, on.tree, on.rows.of_node(), own.set)
                      : detail::extended(backend, own.rows, own.rows.size());
      std::vector<Point<Dim>> places;
      if (!own.motion.is_uniform()) places = places_of(backend, on.points, rows);
      parts.driven.emplace_back(backend, own.motion, own.directions, std::move(rows),
                                std::move(places), parts.layout.node_rows_when_asked());
    }
  }

  /// Makes the force terms of pressures of such parts.
  template <class Parts, class On>
  void press(Parts& parts, On const& on) const {
    for (auto const& own : pressed_) {
      if (own.pascals == 0) continue;
      std::size_t type = 0;
      parts.for_each_type([&](auto const& table, auto const&) {
        using Table = std::remove_cvref_t<decltype(table)>;
        press_sides<typename Table::element>(parts, on, own, on.leaves(type++));
      });
    }
  }

 private:
  struct Driven {
    Motion<Dim> motion;
    DirectionMask directions;
    bool is_of_facets;
    std::size_t set;    // of facets
    Array<Index> rows;  // else
  };
  struct Pressed {
    double pascals;
    std::size_t set;
  };

  /// Those of elements of one type.
  template <Element E, class Parts, class On>
  static void press_sides(Parts& parts, On const& on, Pressed const& own,
                          LeavesView const& leaves) {
    [&]<Element... Faces>(detail::TypeList<Faces...>) {
      (press_faces<Faces, E>(parts, on, own, leaves), ...);
    }(detail::faces_of<E>());
  }
  template <Element Face, Element E, class Parts, class On>
  static void press_faces(Parts& parts, On const& on, Pressed const& own,
                          LeavesView const& leaves) {
    using Physics = detail::PressureOn<Dim, Face>;
    using Term = ConnectedTerm<B, Physics::template physics>;
    constexpr int width = row_width<typename Term::Elements>;
    auto rows = on.held.template facets_of_set<E, Face::cell::corners, width>(
        parts.backend, on.tree, leaves, on.rows.of_node(), own.set);
    if (rows.size() == 0) return;
    parts.pressures.push_back(Term::of_rows(parts.backend, std::move(rows),
                                            typename Physics::template physics<double>{own.pascals},
                                            parts.layout.rows));
  }
  static std::vector<Point<Dim>> places_of(B const& backend, Array<double> const& points,
                                           Array<Index> const& rows) {
    auto taken = zeros<double>(backend, node_stride * rows.size());
    backend.for_each(static_cast<Index>(rows.size()),
                     detail::TakeRows<double, Dim>{node_field<Dim>(points), node_field<Dim>(taken),
                                                   rows.data()});
    auto const all = download<double>(taken);
    std::vector<Point<Dim>> places(rows.size());
    for (std::size_t n = 0; n < places.size(); ++n)
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(node_stride * n), Dim,
                  places[n].begin());
    return places;
  }

  std::vector<Driven> driven_;
  std::vector<Pressed> pressed_;
};

}  // namespace pliant

#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <typeinfo>
#include <vector>

#include <pliant/backend/dispatch.hpp>
#include <pliant/body/groups.hpp>
#include <pliant/topology/patterns.hpp>
#include <pliant/topology/transfer.hpp>

// What quadrature points keep, from one mesh to another.
namespace pliant::detail {

/// What the points of the elements of one type keep, on the host.
template <int Dim>
struct KeptPoints {
  struct Group {
    std::vector<Vector<double, Dim>> places;  // of points on the cell
    int size = 0;                             // numbers per point
    std::type_info const* law = nullptr;
  };
  std::vector<double> rows;  // (elements, width), by the user's number
  std::size_t width = 0;
  std::vector<Tag> tags;      // (elements)
  std::vector<Group> groups;  // by tag
};

/// The points of a formulation. `size` is 0 where they keep nothing.
template <class F>
typename KeptPoints<F::dim>::Group points_of() {
  constexpr auto rule = F::quadrature::template rule<typename F::element::cell>();
  typename KeptPoints<F::dim>::Group group;
  for (int q = 0; q < F::points; ++q) {
    auto& place = group.places.emplace_back();
    for (int k = 0; k < F::dim; ++k) place[k] = rule.points[q][k];
  }
  group.size = internal_variables_of<F> / F::points;
  group.law = &typeid(typename F::template law<double>);
  return group;
}

/// Of all element types of a body.
template <class Parts>
std::vector<KeptPoints<Parts::dim>> kept_points(Parts const& parts) {
  std::vector<KeptPoints<Parts::dim>> kept;
  parts.for_each_type([&](auto const& table, auto const& elements) {
    using Table = std::remove_cvref_t<decltype(table)>;
    auto& own = kept.emplace_back();
    if constexpr (Parts::has_internal_variables) {
      own.width = Table::Laws::internal_variable_count;
      own.rows = table.in_user_order(elements.internal_variables);
      own.tags = user_groups<typename Table::element>(parts);
      [&]<int... G>(std::integer_sequence<int, G...>) {
        (own.groups.push_back(points_of<typename Table::template formulation<G>>()), ...);
      }(std::make_integer_sequence<int, Table::groups>());
    }
  });
  return kept;
}

/// Looks for the nearest of some places; the first of those that are equally near but for rounding.
class NearestPlace {
 public:
  /// Whether a place is nearer to another than all before.
  template <int Dim>
  bool is_nearer(Vector<double, Dim> const& place, Vector<double, Dim> const& at) {
    double const apart = dot(place - at, place - at);
    if (!(apart < least_ - rounding)) return false;
    least_ = apart;
    return true;
  }

 private:
  static constexpr double rounding = 1e-12;  // of places on cells of size one
  double least_ = std::numeric_limits<double>::infinity();
};

/// What the points of the elements of a type keep on the new mesh.
struct CarriedPoints {
  std::vector<double> rows;   // (elements, variables), by the user's number
  std::vector<bool> at_rest;  // (elements): their law kept nothing before; empty: none is
};

/// Each point takes what the nearest point of its ancestors keeps, of those in groups of the same law. `tags`: the groups of
/// the new elements.
template <class Table, int Dim>
CarriedPoints carried_points(std::vector<KeptPoints<Dim>> const& kept, std::vector<Tag> const& tags,
                             Transfer<Dim> const& transfer, std::size_t type) {
  using Cell = typename Table::element::cell;
  using Family = typename Transfer<Dim>::Family;
  using Member = typename Transfer<Dim>::Member;
  using Origin = typename Transfer<Dim>::Origin;
  constexpr std::size_t width{Table::Laws::internal_variable_count};
  auto const& origins = transfer.origins(type);
  if (width == 0) return {};
  std::size_t const count = transfer.elements(type);
  CarriedPoints carried{std::vector<double>(width * count), {}};
  std::size_t e = 0;
  auto const carry_one = [&](Origin const& origin) {
    Family const family = origin.family >= 0
                              ? transfer.families()[static_cast<std::size_t>(origin.family)]
                              : Family{};
    auto const fill = [&]<int G>(GroupNumber<G>) {
      auto const now = points_of<typename Table::template formulation<G>>();
      for (std::size_t q = 0; now.size > 0 && q < now.places.size(); ++q) {
        auto at = now.places[q];
        if (origin.child >= 0)
          at = on_parent<Cell>(at, *family.pattern, origin.child, family.mirrored);
        NearestPlace nearest;
        double const* from = nullptr;
        auto const look_at = [&](Member const& member, auto const& place_of) {
          auto const& old = kept[member.type];
          auto const number = static_cast<std::size_t>(member.element);
          auto const& group = old.groups[old.tags[number]];
          if (*group.law != *now.law) return;
          for (std::size_t p = 0; p < group.places.size(); ++p) {
            if (!nearest.is_nearer(place_of(group.places[p]), at)) continue;
            from = &old.rows[old.width * number + static_cast<std::size_t>(group.size) * p];
          }
        };
        if (origin.child == Origin::merged)
          for (int c = 0; c < static_cast<int>(family.before.size()); ++c)
            look_at(family.before[static_cast<std::size_t>(c)], [&](auto const& xi) {
              Vector<double, Dim> place;
              visit_cell(family.pattern->child_kind[static_cast<std::size_t>(c)],
                         [&]<class Child>(Child) {
                           if constexpr (Child::dim == Dim)
                             place = on_parent<Child>(xi, *family.pattern, c, family.mirrored);
                         });
              return place;
            });
        else
          look_at({origin.type < 0 ? type : static_cast<std::size_t>(origin.type), origin.element},
                  [](auto const& xi) { return xi; });
        if (from == nullptr) {
          carried.at_rest.resize(count, false);
          carried.at_rest[e] = true;
          return;
        }
        auto const size = static_cast<std::size_t>(now.size);
        std::copy_n(from, size, &carried.rows[width * e + size * q]);
      }
    };
    dispatch<Table::groups>(tags[e], fill);
    ++e;
  };
  for (Origin origin : origins)
    for (Index const end = origin.element + origin.count; origin.element < end; ++origin.element)
      carry_one(origin);
  return carried;
}

}  // namespace pliant::detail

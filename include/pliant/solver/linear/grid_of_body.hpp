#pragma once

#include <pliant/backend/backend.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/solver/linear/background_grid.hpp>

namespace pliant::detail {

/// The finest grid around a body, relative to its middle as its nodes at rest are, and in which box things lie: nodes by
/// their internal numbers, −1 for those of no element, and elements of each type by theirs.
template <int Dim>
struct GridOfBody {
  BackgroundGrid<Dim> grid;
  std::vector<Index> boxes_of_nodes{};
  std::vector<std::vector<Index>> boxes_of_elements{};
};

/// Whether elements, but for a twentieth, lie in the boxes of the finest grid, and fill more than half of them along each axis:
/// then the grid's functions are as good as linear ones on the elements' own cells.
template <class Parts>
bool lies_in_boxes(Parts const& parts) {
  auto const& mesh = parts.state.topology->mesh();
  auto const grid = grid_around(mesh, GridFor::nodes);
  constexpr double rounding = 0.05;  // of a box
  std::size_t others = 0, all = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    for (auto const& element : mesh.template elements<E>()) {
      bool fits = true;
      for (std::size_t k = 0; k < E::dim; ++k) {
        double low = INFINITY, high = -INFINITY;  // in boxes
        for (std::size_t a = 0; a < E::cell::corners; ++a) {
          double const x = mesh.nodes[static_cast<std::size_t>(element[a])][k] - grid.low[k];
          low = std::min(low, x / grid.spacing[k]);
          high = std::max(high, x / grid.spacing[k]);
        }
        fits = fits && high - low > 0.5 &&
               std::ceil(high - rounding) <= std::floor(low + rounding) + 1;
      }
      others += fits ? 0 : 1;
      ++all;
    }
  });
  return 20 * others <= all;
}

/// Elements lie where the middle of their corners is, and nodes where they are, or with an element of theirs if that box
/// has none.
template <class Parts>
GridOfBody<Parts::dim> grid_of_body(Parts const& parts, GridFor finer) {
  constexpr std::size_t dim = Parts::dim;
  using Place = typename BackgroundGrid<Parts::dim>::Place;
  auto const& mesh = parts.state.topology->mesh();
  GridOfBody<Parts::dim> body{grid_around(mesh, finer)};
  auto& grid = body.grid;
  auto const relative = [&](Point<dim> x) {
    for (std::size_t k = 0; k < dim; ++k) x[k] -= parts.layout.middle[k];
    return x;
  };
  grid.low = relative(grid.low);
  std::vector<Place> occupied, at_element(mesh.nodes.size());
  std::vector<bool> has_element(mesh.nodes.size(), false);
  parts.for_each_type([&](auto const& table, auto const&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const& elements = mesh.template elements<E>();
    for (Index user : table.user_elements()) {
      auto const& element = elements[static_cast<std::size_t>(user)];
      Point<dim> middle{};
      for (std::size_t a = 0; a < E::cell::corners; ++a)
        for (std::size_t k = 0; k < dim; ++k)
          middle[k] += mesh.nodes[static_cast<std::size_t>(element[a])][k] / E::cell::corners;
      occupied.push_back(grid.place_of(relative(middle)));
      for (Index i : element) {
        at_element[static_cast<std::size_t>(i)] = occupied.back();
        has_element[static_cast<std::size_t>(i)] = true;
      }
    }
  });
  grid.number(occupied);

  body.boxes_of_nodes.assign(static_cast<std::size_t>(parts.layout.rows), -1);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!has_element[i]) continue;
    Index box = grid.find_box(grid.place_of(relative(mesh.nodes[i])));
    if (box < 0) box = grid.find_box(at_element[i]);
    body.boxes_of_nodes[static_cast<std::size_t>(parts.layout.internal_of(static_cast<Index>(i)))] =
        box;
  }
  auto place = occupied.begin();
  parts.for_each_type([&](auto const& table, auto const&) {
    auto& boxes = body.boxes_of_elements.emplace_back();
    for (Index e = 0; e < table.count(); ++e) boxes.push_back(grid.find_box(*place++));
  });
  return body;
}

/// The elements of one type by boxes of a grid, in the memory of a backend.
template <Backend B, int Dim>
struct ElementHomes {
  using T = typename B::scalar;
  typename B::template Array<T> low;                // (Dim, elements): lowest corners, m
  typename B::template Array<Index> first, member;  // elements by boxes

  ElementHomes(B const& backend, BackgroundGrid<Dim> const& grid, std::vector<Index> const& boxes) {
    std::vector<T> corners(Dim * boxes.size());
    for (std::size_t e = 0; e < boxes.size(); ++e) {
      auto const corner = grid.point_at(grid.box[static_cast<std::size_t>(boxes[e])]);
      for (std::size_t k = 0; k < Dim; ++k)
        corners[k * boxes.size() + e] = static_cast<T>(corner[k]);
    }
    auto const by_box = group_by_key(boxes, static_cast<Index>(grid.box.size()));
    low = upload(backend, corners);
    first = upload(backend, by_box.first);
    member = upload(backend, by_box.order);
  }
};

}  // namespace pliant::detail

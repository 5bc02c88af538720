#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <pliant/math/power.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant::detail {

/// The number of the neighbour at corner b of a node at corner a of one box: Σ (offset_k + 1) 3ᵏ.
template <int Dim>
PLIANT_HOST_DEVICE constexpr int offset_between(int a, int b) {
  int sum = 0, weight = 1;
  for (int k = 0; k < Dim; ++k, weight *= 3) sum += ((b >> k & 1) - (a >> k & 1) + 1) * weight;
  return sum;
}

/// A regular grid of boxes around a body, on the host: those boxes where the body is, and their corners. Corner b of a
/// box lies at its upper end along axis k where bit k of b is set.
template <int Dim>
struct BackgroundGrid {
  static constexpr int corners = power(2, Dim), neighbours = power(3, Dim);
  using Place = std::array<Index, Dim>;  // along each axis

  Point<Dim> low{}, spacing{};   // m
  Place boxes{};                 // along each axis, whether the body is there or not
  Place ratio{};                 // how many boxes of the finer grid make one along each axis
  std::vector<Place> box, node;  // in ascending order of their keys
  std::vector<Index> corner;     // (boxes, corners): nodes
  std::vector<Index> around;  // (nodes, corners): the box of which the node is corner b; −1: none
  std::vector<Index> neighbour;  // (nodes, neighbours): see offset_between; −1: none

  /// `occupied`: boxes where the body is, each as often as you like.
  void number(std::vector<Place> const& occupied) {
    box = unique(occupied, box_at_);
    std::vector<Place> ends;
    ends.reserve(box.size() * corners);
    for (auto const& place : box)
      for (int b = 0; b < corners; ++b) ends.push_back(corner_of(place, b));
    node = unique(ends, node_at_);
    corner.resize(ends.size());
    around.assign(node.size() * corners, -1);
    neighbour.assign(node.size() * neighbours, -1);
    for (std::size_t k = 0; k < ends.size(); ++k) {
      corner[k] = find(node, node_at_, ends[k]);
      around[static_cast<std::size_t>(corner[k]) * corners + k % corners] =
          static_cast<Index>(k / corners);
    }
    for (std::size_t e = 0; e < box.size(); ++e)
      for (int a = 0; a < corners; ++a)
        for (int b = 0; b < corners; ++b)
          neighbour[static_cast<std::size_t>(corner[e * corners + static_cast<std::size_t>(a)]) *
                        neighbours +
                    static_cast<std::size_t>(offset_between<Dim>(a, b))] =
              corner[e * corners + static_cast<std::size_t>(b)];
  }

  static Place corner_of(Place place, int b) {
    for (std::size_t k = 0; k < Dim; ++k) place[k] += b >> k & 1;
    return place;
  }
  /// The box around a point; one at the border for what lies beyond.
  Place place_of(Point<Dim> const& x) const {
    Place place;
    for (std::size_t k = 0; k < Dim; ++k)
      place[k] = static_cast<Index>(
          std::clamp(std::floor((x[k] - low[k]) / spacing[k]), 0.0, boxes[k] - 1.0));
    return place;
  }
  Point<Dim> point_at(Place const& place) const {
    Point<Dim> x;
    for (std::size_t k = 0; k < Dim; ++k) x[k] = low[k] + spacing[k] * place[k];
    return x;
  }
  /// The number of a box; −1 where the body is not.
  Index find_box(Place const& place) const { return find(box, box_at_, place); }

  /// Boxes of twice the size along those axes where they are small, as long as there are several: point by point
  /// smoothing does little along the others.
  bool can_be_coarser() const {
    return std::ranges::any_of(boxes, [](Index n) { return n > 1; });
  }
  BackgroundGrid coarser() const {
    BackgroundGrid grid;
    grid.low = low;
    double least = INFINITY;
    for (std::size_t k = 0; k < Dim; ++k)
      if (boxes[k] > 1) least = std::min(least, spacing[k]);
    for (std::size_t k = 0; k < Dim; ++k) {
      grid.ratio[k] = boxes[k] > 1 && spacing[k] <= 1.5 * least ? 2 : 1;
      grid.spacing[k] = grid.ratio[k] * spacing[k];
      grid.boxes[k] = (boxes[k] + grid.ratio[k] - 1) / grid.ratio[k];
    }
    std::vector<Place> occupied = box;
    for (auto& place : occupied) place = grid.parent_of(place);
    grid.number(occupied);
    return grid;
  }
  /// The box around one of the finer grid's.
  Place parent_of(Place place) const {
    for (std::size_t k = 0; k < Dim; ++k) place[k] /= ratio[k];
    return place;
  }

 private:
  std::int64_t key(Place const& place) const {
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < Dim; ++k) sum = sum * (std::int64_t{boxes[k]} + 1) + place[k];
    return sum;
  }
  auto by_key() const {
    return [this](Place const& a, Place const& b) { return key(a) < key(b); };
  }
  /// Each of the places once, in order, and `at`: their numbers by keys, where few keys are of none, or nothing.
  std::vector<Place> unique(std::vector<Place> places, std::vector<Index>& at) const {
    std::int64_t keys = 1;
    for (Index n : boxes) keys *= std::int64_t{n} + 1;
    at.clear();
    if (keys > 4096 + 8 * std::ssize(places)) {
      std::ranges::sort(places, by_key());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      return places;
    }
    at.assign(static_cast<std::size_t>(keys), -1);
    for (auto const& place : places) at[static_cast<std::size_t>(key(place))] = 0;
    places.clear();
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (at[k] < 0) continue;
      at[k] = static_cast<Index>(places.size());
      places.push_back(place_of_key(static_cast<std::int64_t>(k)));
    }
    return places;
  }
  Place place_of_key(std::int64_t key) const {
    Place place;
    for (std::size_t k = Dim; k-- > 0; key /= boxes[k] + 1)
      place[k] = static_cast<Index>(key % (boxes[k] + 1));
    return place;
  }
  Index find(std::vector<Place> const& places, std::vector<Index> const& at,
             Place const& place) const {
    if (!at.empty()) return at[static_cast<std::size_t>(key(place))];
    auto const found = std::ranges::lower_bound(places, place, by_key());
    return found != places.end() && *found == place ? static_cast<Index>(found - places.begin())
                                                    : -1;
  }

  std::vector<Index> box_at_, node_at_;
};

/// Whose errors a grid makes small: those of all nodes of a body, or of the corners of its cells.
enum class GridFor { nodes, corners };

/// Lays the finest grid around a mesh, without numbers: boxes of two elements' size, one of those that have more nodes than
/// corners if these count, but none smaller than an element, which is to lie in one of them or nearly.
template <Element... Es>
BackgroundGrid<Mesh<Es...>::dim> grid_around(Mesh<Es...> const& mesh, GridFor finer) {
  constexpr std::size_t dim = Mesh<Es...>::dim;
  BackgroundGrid<Mesh<Es...>::dim> grid;
  Point<dim> high, sum{}, largest{};
  grid.low.fill(INFINITY);
  high.fill(-INFINITY);
  double count = 0;
  auto const look_at = [&]<Element E>(std::vector<Connectivity<E>> const& elements) {
    double const wanted = finer == GridFor::nodes && E::nodes > E::cell::corners ? 1 : 2;
    for (auto const& element : elements)
      for (std::size_t k = 0; k < dim; ++k) {
        double least = INFINITY, most = -INFINITY;
        for (std::size_t a = 0; a < E::nodes; ++a) {
          double const x = mesh.nodes[static_cast<std::size_t>(element[a])][k];
          least = std::min(least, x);
          most = std::max(most, x);
        }
        grid.low[k] = std::min(grid.low[k], least);
        high[k] = std::max(high[k], most);
        largest[k] = std::max(largest[k], most - least);
        sum[k] += wanted * (most - least);
      }
    count += static_cast<double>(elements.size());
  };
  (look_at.template operator()<Es>(mesh.template elements<Es>()), ...);
  double least = INFINITY;
  for (std::size_t k = 0; k < dim; ++k) least = std::min(least, sum[k] / count);
  for (std::size_t k = 0; k < dim; ++k) {
    double const mean = sum[k] / count, extent = high[k] - grid.low[k];
    double const size = std::max(mean > 1.5 * least ? mean / 2 : mean, largest[k]);
    grid.boxes[k] = std::max(1, static_cast<Index>(std::ceil(extent / size - 1e-6)));
    grid.spacing[k] = grid.boxes[k] == 1 ? extent : size;
  }
  return grid;
}

}  // namespace pliant::detail

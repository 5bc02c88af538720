#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include <pliant/pliant.hpp>

// Meshes of a square or cube of edge 1, smoothly warped so that no two elements are alike.
namespace pliant::bench {

template <class M>
M warped(M mesh) {
  constexpr std::size_t dim = M::dim;
  for (auto& x : mesh.nodes) {
    auto const rest = x;
    for (std::size_t k = 0; k < dim; ++k)
      x[k] += 0.02 * std::sin(2 * std::numbers::pi * (rest[(k + 1) % dim] + 0.3 * rest[k]));
  }
  return mesh;
}

/// `cells` along each edge.
template <Element E>
Mesh<E> mesh_of(int cells) {
  if constexpr (E::dim == 2)
    return warped(mesh::rectangle<E>({.size = {1, 1}, .cells = {cells, cells}}));
  else
    return warped(mesh::box<E>({.size = {1, 1, 1}, .cells = {cells, cells, cells}}));
}

/// A square has two triangles; a cube six tetrahedra, six pyramids or two wedges.
template <Element E>
long element_count(int cells) {
  using Cell = typename E::cell;
  constexpr bool in_six = std::same_as<Cell, Tetrahedron> || std::same_as<Cell, Pyramid>;
  constexpr bool in_two = std::same_as<Cell, Triangle> || std::same_as<Cell, Wedge>;
  long const n = cells;
  return (E::dim == 2 ? n * n : n * n * n) * (in_six ? 6 : in_two ? 2 : 1);
}

/// The cells along an edge that come nearest to a number of elements.
template <Element E>
int cells_for(double elements) {
  double const per_cell = static_cast<double>(element_count<E>(1));
  return static_cast<int>(std::lround(std::pow(elements / per_cell, 1.0 / E::dim)));
}

/// Displacements of up to a fiftieth of a cell, at random.
template <std::size_t Dim>
std::vector<Point<int{Dim}>> noise(std::vector<std::array<double, Dim>> const& nodes,
                                   unsigned seed) {
  double const cell = std::pow(static_cast<double>(nodes.size()), -1.0 / Dim);
  std::vector<Point<int{Dim}>> u(nodes.size());
  std::uint64_t state = seed;
  for (auto& row : u)
    for (double& x : row) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      x = 0.04 * cell * (static_cast<double>(state >> 40) / (1 << 24) - 0.5);
    }
  return u;
}

/// The same on top of a smooth displacement with a gradient of about 0.2; `size` scales both.
template <std::size_t Dim>
std::vector<Point<int{Dim}>> shaken(std::vector<std::array<double, Dim>> const& nodes,
                                    unsigned seed, double size = 1) {
  auto u = noise(nodes, seed);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) {
      double const phase = 2 * std::numbers::pi * nodes[i][(k + 1) % Dim] + seed;
      u[i][k] = size * (u[i][k] + 0.03 * std::sin(phase));
    }
  return u;
}

}  // namespace pliant::bench

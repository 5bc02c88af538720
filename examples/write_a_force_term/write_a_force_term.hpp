#pragma once

#include <cstdio>

#include <pliant/pliant.hpp>

// A force term is the energy of a few nodes: this file adds one, and drops a block onto it on any backend.
namespace write_a_force_term {
using namespace pliant;

/// A soft floor that a node sinks into: k/2 min(0, y + u_y − h)².
template <class T>
struct Floor {
  static constexpr int nodes = 1, dim = 2;
  T stiffness, height;  // N/m, m

  template <class S>  // forces and tangents follow by automatic differentiation
  PLIANT_HOST_DEVICE S energy(Matrix<S, 1, 2> const& rest, Matrix<S, 1, 2> const& u) const {
    return stiffness / 2 * square(min(rest(0, 1) + u(0, 1) - height, S(0)));
  }
};

void run(auto const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.5}, .cells = {16, 8}, .origin = {0, 0.05}});
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  Body block{backend, mesh, {.young = 1e5, .poisson = 0.3, .density = 1000}, Group<Rubber>{}};
  auto const lower = nodes_of(mesh.boundary("bottom"));
  std::vector<std::array<Index, 1>> sets;
  for (Index node : lower) sets.push_back({node});
  block.add(sets, Floor<double>{.stiffness = 5e4, .height = 0});
  block.set_gravity({0, -10});
  block.set_damping(20);
  CentralDifference step;
  while (block.time() < 2) step(block);
  double depth = 0;  // the floor bears the weight of 5000 N
  for (Index node : lower) depth -= 0.05 + block.displacements()[std::size_t(node)][1];
  std::printf("the floor bears %.1f N, exact %.1f N\n", 5e4 * depth, 5000.0);
}
}  // namespace write_a_force_term

#pragma once

#include <cstdio>

#include <pliant/pliant.hpp>
#include <pliant/solver/newton.hpp>

// An element is a cell and shape functions: this file adds one, and bends beams on any backend.
namespace write_an_element {
using namespace pliant;

/// The linear triangle with a node in its middle, where a bubble b = 27 λ₀ λ₁ λ₂ rises.
struct Tri4 : ElementOn<Triangle, 4, 1> {
  static constexpr char const* name() { return "Tri4"; }

  PLIANT_HOST_DEVICE static constexpr Vector<double, 2> place(int a) {
    return a < 3 ? Triangle::corner(a) : Vector<double, 2>{{{1.0 / 3}, {1.0 / 3}}};
  }
  template <class S>  // gradients are derived by the compiler
  PLIANT_HOST_DEVICE static constexpr Vector<S, 4> shape(Vector<S, 2> const& xi) {
    auto const l = Triangle::linear(xi);
    S const b = 27 * l[0] * l[1] * l[2];
    return {{{l[0] - b / 3}, {l[1] - b / 3}, {l[2] - b / 3}, {b}}};
  }
};

template <Element E, class Q>
void bend(auto const& backend) {
  auto const mesh = mesh::raised<E>(mesh::rectangle<Tri3>({.size = {1, 0.1}, .cells = {40, 4}}));
  Body beam{backend, mesh, {2e6, 0.3, 1e3}, Group<Formulation<E, Q, StableNeoHookean>>{}};
  beam.clamp(mesh.boundary("left"));
  beam.set_gravity({0, -10});
  solve_static(beam, {.load_steps = 4});
  auto const tip = static_cast<std::size_t>(nodes_of(mesh.boundary("right")).front());
  std::printf("%s: the tip sinks by %.4f m\n", E::name(), -beam.displacements()[tip][1]);
}
void run(auto const& backend) {
  bend<Tri3, Gauss<1>>(backend), bend<Tri4, Gauss<4>>(backend), bend<Tri6, Gauss<2>>(backend);
}
}  // namespace write_an_element

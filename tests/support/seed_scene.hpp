#pragma once

#include "support/formulations.hpp"

namespace pliant::test {

/// The cantilever of REFERENCES, sections 10 to 12: 1 m by 0.1 m, 20 x 2 cells, clamped at x = 0.
template <Element E>
Mesh<E> seed_mesh() {
  return mesh::rectangle<E>({.size = {1, 0.1}, .cells = {20, 2}, .origin = {0, -0.05}});
}
inline constexpr Elastic seed_material{2e6, 0.3, 1000};
inline constexpr std::size_t seed_tip = 20 + 21;  // the node at (1, 0)

template <class F, Backend B>
auto seed_body(B const& backend) {
  auto const mesh = seed_mesh<typename F::element>();
  Body body{backend, mesh, seed_material, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -10});
  return body;
}

}  // namespace pliant::test

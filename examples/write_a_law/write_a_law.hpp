#pragma once

#include <cstdio>

#include <pliant/pliant.hpp>

// A law is its energy: this file adds one, and stretches a block of it on any backend.
namespace write_a_law {
using namespace pliant;
/// Foamed rubber with ν = 1/4 (Blatz and Ko 1962): W = μ/2 (I₂/J² + 2 J − 5). In invariants that vanish
/// at rest small strains keep their digits: with D₂ = I₂ − 3 − 4 j and j = J − 1 the bracket is this. For J > 0.
template <class T>
struct BlatzKo {
  T mu;  // shear modulus, Pa

  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalInvariants<S> const& i) const {
    S const j = i.J_minus_1;
    return mu / 2 * (i.D2 + j * j + 2 * j * j * j) / square(positive_or_nan(1 + j));
  }
};

/// Between plates that hold it sideways: the pull is μ (1 − stretch⁻³) per area.
template <class TheBackend>
void run(TheBackend const& backend) {
  auto const mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {4, 4, 4}});
  using Foam = Formulation<Tet4, Gauss<1>, BlatzKo>;
  Body block{
      backend, mesh, {.young = 2.5e5, .poisson = 0.25, .density = 100}, Group<Foam>{{{1e5}}}};
  for (double stretch : {0.8, 1.0, 1.25, 1.5}) {
    auto u = mesh.nodes;
    for (auto& p : u) p = {(stretch - 1) * p[0], 0, 0};
    block.set_displacements(u);
    double pull = 0;
    for (Index i : nodes_of(mesh.boundary("left"))) pull += block.forces()[std::size_t(i)][0];
    std::printf("stretch %4.2f: pull %9.1f N, exact %9.1f N\n", stretch, pull,
                1e5 * (1 - std::pow(stretch, -3)));
  }
}
}  // namespace write_a_law

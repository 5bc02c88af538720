#pragma once

#include <cmath>
#include <cstdio>
#include <random>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

// How many digits single precision keeps: nodal forces and energies in float against Reference in
// double, for strains from 1 down to 1e-5. Prints rows of comma-separated values. Every law on Tri3 and
// Tet4; three of them on Quad4 and Hex8 too, as elements add their own rounding to whatever the law.
namespace float_error {

using namespace pliant;

/// Cells with moved nodes, far from the origin as meshes are in practice.
template <Element E>
Mesh<E> warped_mesh() {
  Mesh<E> mesh;
  if constexpr (E::dim == 2)
    mesh = mesh::rectangle<E>({.size = {1, 1}, .cells = {8, 8}, .origin = {100, -50}});
  else
    mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {6, 6, 6}, .origin = {100, -50, 20}});
  double const h = 1.0 / (E::dim == 2 ? 8 : 6);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.15 * h, 0.15 * h);
  for (auto& node : mesh.nodes)
    for (double& x : node) x += shift(random);
  return mesh;
}

template <class F, class TheBackend>
void rows(TheBackend const& backend, char const* law, Group<F> const& group = {}) {
  using E = typename F::element;
  constexpr int dim = F::dim;
  auto const mesh = warped_mesh<E>();
  Elastic const material{.young = 1e6, .poisson = 0.3, .density = 1e3};
  Body exact{Reference<double>{}, mesh, material, group};
  Body single{backend, mesh, material, group};
  double const h = 1.0 / (dim == 2 ? 8 : 6);
  for (double strain : {1.0, 0.3, 0.1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5}) {
    // A random mean gradient, and a sixth of it at random from node to node: no element inverts.
    std::mt19937 random(11);
    std::uniform_real_distribution<double> part(-1, 1);
    double gradient[3][3];
    for (auto& row : gradient)
      for (double& g : row) g = 0.3 * strain * part(random);
    std::vector<Point<dim>> u(mesh.nodes.size());
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k) {
        double x = 0.05 * strain * h * part(random);
        for (std::size_t j = 0; j < dim; ++j)
          x += gradient[k][j] * (mesh.nodes[i][j] - mesh.nodes[0][j]);
        u[i][k] = static_cast<double>(static_cast<float>(x));  // both see the same numbers
      }
    exact.set_displacements(u);
    single.set_displacements(u);
    auto const f = exact.forces(), g = single.forces();
    double error = 0, largest = 0;
    for (std::size_t i = 0; i < f.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k) {
        error = std::max(error, std::abs(f[i][k] - g[i][k]));
        largest = std::max(largest, std::abs(f[i][k]));
      }
    double const w = strain_energy(exact), w_single = strain_energy(single);
    if (!std::isfinite(w + w_single)) throw Error("float_error: an energy is not finite");
    std::printf("%s,%s,%s,%g,%.3e,%.3e\n", TheBackend::name(), E::name(), law, strain,
                error / largest, std::abs(w_single - w) / w);
  }
}

template <Element E, class Q, class TheBackend>
void few_laws(TheBackend const& backend) {
  rows<Formulation<E, Q, Hooke>>(backend, "Hooke");
  rows<Formulation<E, Q, SaintVenantKirchhoff>>(backend, "SaintVenantKirchhoff");
  rows<Formulation<E, Q, NeoHookean>>(backend, "NeoHookean");
}

template <Element E, class Q, class TheBackend>
void all_laws(TheBackend const& backend) {
  few_laws<E, Q>(backend);
  rows<Formulation<E, Q, StableNeoHookean>>(backend, "StableNeoHookean");
  rows<Formulation<E, Q, IsochoricNeoHookean>>(backend, "IsochoricNeoHookean");
  rows<Formulation<E, Q, SimoNeoHookean>>(backend, "SimoNeoHookean");
  rows<Formulation<E, Q, MooneyRivlin>>(backend, "MooneyRivlin");
  rows<Formulation<E, Q, Yeoh>>(backend, "Yeoh", {{{2e5, 4e4, 2e4, 8e5}}});
  rows<Formulation<E, Q, Ogden>>(backend, "Ogden");
  rows<Formulation<E, Q, ArrudaBoyce>>(backend, "ArrudaBoyce");
  rows<Formulation<E, Q, Gent>>(backend, "Gent");
  rows<Formulation<E, Q, Fung>>(backend, "Fung");
  rows<Formulation<E, Q, Corotated>>(backend, "Corotated");
  rows<Formulation<E, Q, Guccione>>(backend, "Guccione", {{{4e5, 4, 1, 2, 8e5}}, {{3, 4, 1}}});
  rows<Formulation<E, Q, HolzapfelGasserOgden>>(
      backend, "HolzapfelGasserOgden", {{{4e5, 2e5, 0.5, 0.1, 8e5}}, {{2, 1, 1, -1, 2, 0.5}}});
}

template <class TheBackend>
int main(TheBackend const& backend) {
  std::puts("backend,element,law,strain,force error over largest force,relative energy error");
  all_laws<Tri3, Gauss<1>>(backend);
  few_laws<Quad4, Gauss<2>>(backend);
  all_laws<Tet4, Gauss<1>>(backend);
  few_laws<Hex8, Gauss<2>>(backend);
  return 0;
}

}  // namespace float_error

#pragma once

#include <map>

#include "support/formulations.hpp"

// The patch test (REFERENCES: any mesh with inner nodes moved at random): an element that passes
// represents uniform states exactly, whatever its shape.
namespace pliant::test::patch_suite {

/// The displacement gradients H = F − I of the test, by the dimension.
template <int Dim>
std::map<std::string, Tensor<double, Dim>> uniform_states() {
  std::map<std::string, Tensor<double, Dim>> states;
  auto const identity = Tensor<double, Dim>::identity();
  auto h = Tensor<double, Dim>::zero();
  h(0, 0) = 0.2;
  states["stretch"] = h;
  h = Tensor<double, Dim>::zero();
  h(0, 1) = 0.4;
  states["simple shear"] = h;
  double const stretches[] = {1.1, 0.9, 1.05}, angle = 37 * std::acos(-1.0) / 180;
  auto rotation = identity, stretch = identity;
  rotation(0, 0) = rotation(1, 1) = std::cos(angle);
  rotation(1, 0) = std::sin(angle);
  rotation(0, 1) = -std::sin(angle);
  for (int i = 0; i < Dim; ++i) stretch(i, i) = stretches[i];
  states["rotated stretch"] = rotation * stretch - identity;
  return states;
}

/// What rounding may leave of the force on a node: displacements are kept to half a unit in the last
/// place, each element around the node makes a force of at most its stiffness ~ (λ + 2μ) h^(d − 2)
/// from that, and a rounding unit of it in each of some dozen operations more.
template <class T, class M>
double force_rounding(M const& mesh, FieldOf<M::dim> const& u, Elastic const& material,
                      double element_size) {
  double const stiffness =
      (material.lame_lambda() + 2 * material.lame_mu()) * std::pow(element_size, M::dim - 2);
  return 32 * double{std::numeric_limits<T>::epsilon()} * stiffness *
         std::max(largest(u), largest(mesh.nodes));
}

TEST_CASE("a uniform state leaves no force inside, and its stress on the outside",
          "[formulation]") {
  on_each_formulation<PairedBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    int const n = dim == 2 ? 6 : 4;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_among_all<F>(B{}, mesh);
    for (auto const& [name, h] : uniform_states<dim>()) {
      INFO(name);
      auto const u = uniform(mesh.nodes, h);

      auto const f = forces_at(body, u);

      double const tolerance = force_rounding<typename B::scalar>(mesh, u, soft, 1.0 / n);
      double inside = 0;
      for (Index i : inner_nodes(mesh))
        for (double x : f[static_cast<std::size_t>(i)]) inside = std::max(inside, std::abs(x));
      CHECK(inside < tolerance);
      // On a linear field v = G X the forces do the work −P:G V.
      auto const p = stress(law_at_a_point<F>(body), h);
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) {
          auto g = Tensor<double, dim>::zero();
          g(i, k) = 1;
          CHECK(-inner(f, uniform(mesh.nodes, g)) ==
                Approx(p(i, k)).margin(tolerance * static_cast<double>(mesh.nodes.size())));
        }
      CHECK(strain_energy(body) ==
            Approx(energy_density(law_at_a_point<F>(body), h)).epsilon(0).margin(tolerance * n));
    }
  });
}

TEST_CASE("a uniform state of mixed triangles and quadrilaterals leaves no force inside",
          "[formulation]") {
  on_each_backend<PairedBackends>([]<class B>(B const& backend) {
    int const n = 8;
    auto const mesh = mixed_mesh(n);
    Body body{backend, mesh, soft, Group<Formulation<Quad4, Gauss<2>, NeoHookean>>{},
              Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{}};
    for (auto const& [name, h] : uniform_states<2>()) {
      INFO(name);
      auto const u = uniform(mesh.nodes, h);

      auto const f = forces_at(body, u);

      double const tolerance = force_rounding<typename B::scalar>(mesh, u, soft, 1.0 / n);
      for (Index i : inner_nodes(mesh))
        for (double x : f[static_cast<std::size_t>(i)]) CHECK(std::abs(x) < tolerance);
      CHECK(largest(f) > 100 * tolerance);
    }
  });
}

}  // namespace pliant::test::patch_suite

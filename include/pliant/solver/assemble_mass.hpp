#pragma once

#include <pliant/formulation/mass.hpp>
#include <pliant/solver/assemble.hpp>

namespace pliant {

/// How inertia is spread: over the nodes that share an element, ∫ ρ N_a N_b dV, or to each node alone,
/// as explicit integration needs it (Body::add_lumped_mass).
enum class MassMatrix { consistent, lumped };

/// The mass matrix of a body, kg: rows run over (node, direction) in the user's order. Slaves' rows and
/// columns are handed to their masters.
template <DeformableBody TheBody>
Eigen::SparseMatrix<double> assemble_mass(TheBody const& body,
                                          MassMatrix kind = MassMatrix::consistent) {
  constexpr int dim = TheBody::dim;
  auto const& parts = body.parts();
  auto const& mesh = body.mesh();
  std::vector<Eigen::Triplet<double>> entries;
  auto const add = [&](Index i, Index j, double mass) {
    for (int k = 0; k < dim; ++k) entries.emplace_back(dim * i + k, dim * j + k, mass);
  };
  if (kind == MassMatrix::lumped) {
    for (Index i = 0; i < body.nodes(); ++i)
      add(i, i, parts.layout.mass_list[static_cast<std::size_t>(i)]);
  } else {
    auto const& interpolation = parts.state.topology->interpolation;
    parts.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      static constexpr auto points = tabulate<E, MassQuadrature<E>, double>();
      for (Connectivity<E> const& nodes : mesh.template elements<E>()) {
        auto const x = Coefficients<E, double>::of(nodal(mesh, nodes));
        auto m = Tensor<double, E::nodes>::zero();
        for (int q = 0; q < points.count; ++q) {
          double const mass = body.material().density * points.weight[q] *
                              RestMap<E, double>::at(x, points, q).volume;
          for (int a = 0; a < E::nodes; ++a)
            for (int b = 0; b < E::nodes; ++b)
              m(a, b) += mass * points.shape[q][a] * points.shape[q][b];
        }
        for (int a = 0; a < E::nodes; ++a)
          interpolation.for_each_master(
              nodes[static_cast<std::size_t>(a)], [&](Index i, double wi) {
                for (int b = 0; b < E::nodes; ++b)
                  interpolation.for_each_master(
                      nodes[static_cast<std::size_t>(b)],
                      [&](Index j, double wj) { add(i, j, wi * wj * m(a, b)); });
              });
      }
    });
  }
  Eigen::Index const size = Eigen::Index{dim} * body.nodes();
  Eigen::SparseMatrix<double> mass(size, size);
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

}  // namespace pliant

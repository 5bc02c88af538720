#pragma once

#include <pliant/formulation/mass.hpp>
#include <pliant/solver/assemble.hpp>

namespace pliant {

/// How inertia is spread: over the nodes that share an element, ∫ ρ N_a N_b dV, or to each node alone,
/// as explicit integration needs it (Body::masses).
enum class MassMatrix { consistent, lumped };

/// The mass matrix of a body, kg: rows run over (node, direction) in the user's order. Slaves' rows and
/// columns are handed to their masters.
template <class TheBody>
Eigen::SparseMatrix<double> assemble_mass(TheBody const& body,
                                          MassMatrix kind = MassMatrix::consistent) {
  constexpr int dim = TheBody::dim;
  auto const& layout = body.layout();
  std::vector<Eigen::Triplet<double>> entries;
  auto const add = [&](Index i, Index j, double mass) {
    for (int k = 0; k < dim; ++k) entries.emplace_back(dim * i + k, dim * j + k, mass);
  };
  if (kind == MassMatrix::lumped) {
    for (Index i = 0; i < layout.nodes; ++i) add(i, i, body.masses()[static_cast<std::size_t>(i)]);
  } else {
    // Each node's row of the interpolation T: itself, or its masters.
    std::vector<std::vector<std::pair<Index, double>>> row_of(
        static_cast<std::size_t>(layout.nodes));
    for (Index i = 0; i < layout.nodes; ++i) row_of[static_cast<std::size_t>(i)] = {{i, 1.0}};
    for (auto const& slave : layout.slave_list)
      row_of[static_cast<std::size_t>(slave.node)] = slave.masters;

    body.for_each_table([&](auto const& table) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      static constexpr auto points = tabulate<E, MassQuadrature<E>, double>();
      for (Connectivity<E> const& nodes : body.mesh().template elements<E>()) {
        auto const x = Coefficients<E, double>::of(nodal(body.mesh(), nodes));
        auto m = Tensor<double, E::nodes>::zero();
        for (int q = 0; q < points.count; ++q) {
          double const mass = body.material().density * points.weight[q] *
                              RestMap<E, double>::at(x, points, q).volume;
          for (int a = 0; a < E::nodes; ++a)
            for (int b = 0; b < E::nodes; ++b)
              m(a, b) += mass * points.shape[q][a] * points.shape[q][b];
        }
        for (std::size_t a = 0; a < E::nodes; ++a)
          for (std::size_t b = 0; b < E::nodes; ++b)
            for (auto const& [i, wi] : row_of[static_cast<std::size_t>(nodes[a])])
              for (auto const& [j, wj] : row_of[static_cast<std::size_t>(nodes[b])])
                add(i, j, wi * wj * m(static_cast<int>(a), static_cast<int>(b)));
      }
    });
  }
  Eigen::Index const size = Eigen::Index{dim} * layout.nodes;
  Eigen::SparseMatrix<double> mass(size, size);
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

}  // namespace pliant

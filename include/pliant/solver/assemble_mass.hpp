#pragma once

#include <pliant/solver/assemble.hpp>
#include <pliant/solver/linear/same_registers.hpp>
#include <pliant/solver/mass_product.hpp>

namespace pliant {

namespace detail {

/// The mass matrix of a body, kg, in blocks of a node and a node.
template <DeformableBody TheBody>
BlockMatrix<TheBody::dim, TheBody::dim> mass_blocks(TheBody const& body, MassMatrix kind) {
  constexpr int dim = TheBody::dim;
  auto const& parts = body.parts();
  auto const& mesh = body.mesh();
  auto const& interpolation = parts.state.topology->interpolation;
  AssembledBlocks<dim> sum;
  HostTasks const tasks(parts.backend);
  if (kind == MassMatrix::lumped) {
    sum.stiffness = CoupledNodes(interpolation, body.nodes()).template blocks<dim>();
    sum.stiffness.clear_values();
    for (Index i = 0; i < body.nodes(); ++i)
      for (int k = 0; k < dim; ++k)
        sum.stiffness.at(i)[(dim + 1) * k] = parts.layout.mass_list()[static_cast<std::size_t>(i)];
    return std::move(sum.stiffness);
  }
  sum.stiffness = stiffness_blocks(parts, {});
  Assembler<dim> assembler(tasks, interpolation, Assemble::stiffness, body.nodes(), sum);
  parts.for_each_type([&](auto const& table, auto const&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    static constexpr auto points = tabulate<E, MassQuadrature<E>, double>();
    auto const& elements = mesh.template elements<E>();
    auto const nodes_of = [&](Index e) -> auto const& {
      return elements[static_cast<std::size_t>(e)];
    };
    assembler.add_elements(static_cast<Index>(elements.size()), nodes_of,
                           [&](Index e, double*, double* to) {
                             auto const x = Coefficients<E, double>::of(nodal(mesh, nodes_of(e)));
                             constexpr int width = dim * E::nodes;
                             for (int q = 0; q < points.count; ++q) {
                               double const mass = body.material().density * points.weight[q] *
                                                   RestMap<E, double>::at(x, points, q).volume;
                               for (int a = 0; a < E::nodes; ++a)
                                 for (int b = 0; b < E::nodes; ++b)
                                   for (int k = 0; k < dim; ++k)
                                     to[width * (dim * a + k) + dim * b + k] +=
                                         mass * points.shape[q][a] * points.shape[q][b];
                             }
                             return 0.0;
                           });
  });
  return std::move(sum.stiffness);
}

}  // namespace detail

/// The mass matrix of a body, kg: rows run over (node, direction) in the user's order. Slaves' rows and
/// columns are handed to their masters.
template <DeformableBody TheBody>
Eigen::SparseMatrix<double> assemble_mass(TheBody const& body,
                                          MassMatrix kind = MassMatrix::consistent) {
  detail::check_registers();
  auto mass = detail::by_scalars(detail::mass_blocks(body, kind));
  mass.prune([](auto, auto, double entry) { return entry != 0; });
  return mass;
}

}  // namespace pliant

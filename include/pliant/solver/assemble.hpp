#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <pliant/body/body.hpp>

namespace pliant {

/// What a body's elements and pressures make of a displacement, assembled on the host in double precision,
/// whatever the body's own; rows run over (node, direction) in the user's order.
struct Assembled {
  double energy = 0;                      // W, J
  Eigen::VectorXd force;                  // −∂W/∂u, and of pressures, N
  Eigen::SparseMatrix<double> stiffness;  // −∂force/∂u, N/m; empty when not asked for
};

namespace detail {
/// A table of rows as one of columns.
inline std::vector<double> columns(std::vector<double> const& rows, std::size_t count) {
  std::vector<double> turned(rows.size());
  std::size_t const width = count > 0 ? rows.size() / count : 0;
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t k = 0; k < width; ++k) turned[k * count + e] = rows[e * width + k];
  return turned;
}
}  // namespace detail

enum class Assemble { energy_and_force, stiffness_too };

/// Rows and columns of slaves are handed to their masters: their own are zero. `u` must give the
/// slaves their interpolated displacement (see `interpolate_slaves`).
template <class TheBody>
Assembled assemble(TheBody const& body, Eigen::VectorXd const& u,
                   Assemble what = Assemble::stiffness_too, double pressure_share = 1) {
  constexpr int dim = TheBody::dim;
  auto const& layout = body.layout();
  Eigen::Index const size = Eigen::Index{dim} * layout.nodes;
  if (u.size() != size)
    throw Error("assemble: got ", u.size(), " displacements, but the body has ", size,
                " (node by node)");
  // Each node's row of the interpolation T: itself, or its masters.
  std::vector<std::vector<std::pair<Index, double>>> row_of(static_cast<std::size_t>(layout.nodes));
  for (Index i = 0; i < layout.nodes; ++i) row_of[static_cast<std::size_t>(i)] = {{i, 1.0}};
  for (auto const& slave : layout.slave_list)
    row_of[static_cast<std::size_t>(slave.node)] = slave.masters;

  Assembled sum;
  sum.force = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::Triplet<double>> entries;
  body.for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    auto const tags = body.template groups_of<E>();
    auto const& elements = body.mesh().template elements<E>();
    auto const add = [&]<int G>(GroupNumber<G>, std::size_t e, auto const& law) {
      using F = typename Table::template formulation<G>;
      auto const& nodes = elements[e];
      auto const rest = nodal(body.mesh(), nodes);
      Nodal<E, double> own;
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < dim; ++k)
          own(a, k) = u[Eigen::Index{dim} * nodes[static_cast<std::size_t>(a)] + k];
      sum.energy += energy<F>(law, rest, own);
      auto const f = force<F>(law, rest, own);
      for (int a = 0; a < E::nodes; ++a)
        for (auto const& [i, weight] :
             row_of[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])])
          for (int k = 0; k < dim; ++k) sum.force[Eigen::Index{dim} * i + k] += weight * f(a, k);
      if (what == Assemble::energy_and_force) return;
      auto const k = stiffness<F>(law, rest, own);
      for (int a = 0; a < E::nodes; ++a)
        for (auto const& [i, wi] :
             row_of[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])])
          for (int b = 0; b < E::nodes; ++b)
            for (auto const& [j, wj] :
                 row_of[static_cast<std::size_t>(nodes[static_cast<std::size_t>(b)])])
              for (int p = 0; p < dim; ++p)
                for (int q = 0; q < dim; ++q)
                  entries.emplace_back(dim * i + p, dim * j + q,
                                       wi * wj * k(a * dim + p, b * dim + q));
    };
    [&]<int... G>(std::integer_sequence<int, G...>) {
      // Laws with internal variables are at rest.
      typename Table::HostLaws laws{{prepared<typename Table::template formulation<G>>(
          body.template law_of<typename Table::template formulation<G>>(),
          std::numeric_limits<double>::infinity())...}};
      std::vector<double> const values = detail::columns(table.value_rows, elements.size());
      std::vector<double> internal(static_cast<std::size_t>(Table::Laws::internal_variable_count) *
                                   elements.size());
      laws.data = {values.data(), internal.data(), static_cast<Index>(elements.size())};
      for (std::size_t e = 0; e < elements.size(); ++e) {
        OneElement const own{static_cast<Index>(e)};
        (void)((tags[e] == G ? (add(GroupNumber<G>{}, e, laws.template law<G>(own)), true)
                             : false) ||
               ...);
      }
    }(std::make_integer_sequence<int, Table::groups>());
  });
  auto const press = [&]<class Face>(Face, auto const& faces, double pascals) {
    for (auto const& nodes : faces) {
      Matrix<double, Face::nodes, dim> x;
      for (int a = 0; a < Face::nodes; ++a)
        for (int k = 0; k < dim; ++k) {
          Index const node = nodes[static_cast<std::size_t>(a)];
          x(a, k) = body.mesh().nodes[static_cast<std::size_t>(node)][static_cast<std::size_t>(k)] +
                    u[Eigen::Index{dim} * node + k];
        }
      auto const add = [&](auto const& values, auto const& to) {
        for (int a = 0; a < Face::nodes; ++a)
          for (auto const& [i, weight] :
               row_of[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])])
            for (int k = 0; k < dim; ++k) to(dim * i + k, weight * values(a, k));
      };
      add(detail::pressure_force<dim, Face>(pascals, x),
          [&](Index row, double value) { sum.force[row] += value; });
      if (what == Assemble::energy_and_force) continue;
      for (int b = 0; b < Face::nodes; ++b)
        for (int k = 0; k < dim; ++k) {
          auto dx = Matrix<double, Face::nodes, dim>::zero();
          dx(b, k) = 1;
          auto const df = detail::pressure_tangent_product<dim, Face>(pascals, x, dx);
          for (auto const& [j, weight] :
               row_of[static_cast<std::size_t>(nodes[static_cast<std::size_t>(b)])])
            add(df, [&, j = j, weight = weight](Index row, double value) {
              entries.emplace_back(row, dim * j + k, -weight * value);
            });
        }
    }
  };
  for (auto const& pressure : body.pressures())
    detail::for_each_face_type<typename TheBody::mesh_type>(
        pressure.facets, [&](auto face, auto const& faces) {
          press(face, faces, pressure_share * pressure.pascals);
        });
  if (what == Assemble::stiffness_too) {
    sum.stiffness.resize(size, size);
    sum.stiffness.setFromTriplets(entries.begin(), entries.end());
  }
  return sum;
}

/// Gives slaves the displacement that follows from their masters'.
template <class TheBody>
void interpolate_slaves(TheBody const& body, Eigen::VectorXd& u) {
  constexpr int dim = TheBody::dim;
  for (auto const& slave : body.layout().slave_list)
    for (int k = 0; k < dim; ++k) {
      double sum = 0;
      for (auto const& [master, weight] : slave.masters)
        sum += weight * u[Eigen::Index{dim} * master + k];
      u[Eigen::Index{dim} * slave.node + k] = sum;
    }
}

}  // namespace pliant

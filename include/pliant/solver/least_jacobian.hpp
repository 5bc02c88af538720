#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

#include <pliant/body/groups.hpp>

namespace pliant {

/// Where an element of a body is compressed most: det F at its points and between them.
struct LeastJacobian {
  double value = std::numeric_limits<double>::infinity();  // ∞ where there are no elements
  char const* element = "";                                // its type
  Index number = -1;                                       // the user's
};

namespace detail {

/// Points all over a cell, its corners among them: n + 1 along an edge. Pyramids leave out the apex, where
/// shape functions have no gradient.
template <class Cell>
std::vector<Vector<double, Cell::dim>> lattice(int n) {
  std::vector<Vector<double, Cell::dim>> points;
  double const step = 1.0 / n;
  if constexpr (std::same_as<Cell, Triangle>) {
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i) points.push_back({{{step * i}, {step * j}}});
  } else if constexpr (std::same_as<Cell, Tetrahedron>) {
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j + k <= n; ++j)
        for (int i = 0; i + j + k <= n; ++i)
          points.push_back({{{step * i}, {step * j}, {step * k}}});
  } else if constexpr (std::same_as<Cell, Quadrilateral>) {
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back({{{2 * step * i - 1}, {2 * step * j - 1}}});
  } else if constexpr (std::same_as<Cell, Pyramid>) {
    for (int k = 0; k < n; ++k)
      for (auto const& p : lattice<Quadrilateral>(n))
        points.push_back({{{(1 - step * k) * p[0]}, {(1 - step * k) * p[1]}, {step * k}}});
  } else {  // hexahedra and wedges: a plane cell times a line
    using Base = std::conditional_t<std::same_as<Cell, Wedge>, Triangle, Quadrilateral>;
    for (int k = 0; k <= n; ++k)
      for (auto const& p : lattice<Base>(n))
        points.push_back({{{p[0]}, {p[1]}, {2 * step * k - 1}}});
  }
  return points;
}

/// Gradients of an element's shape functions at points between which its map cannot do much.
template <Element E>
std::vector<Matrix<double, E::nodes, E::dim>> const& gradients_on_lattice() {
  static auto const gradients = [] {
    std::vector<Matrix<double, E::nodes, E::dim>> list;
    for (auto const& xi : lattice<typename E::cell>(LinearSimplex<E> ? 1 : 2 * E::degree)) {
      list.push_back(shape_gradient<E>(xi));
      if (LinearSimplex<E>) break;  // the same everywhere
    }
    return list;
  }();
  return gradients;
}

/// Whether the stress of a law is linear in the displacement gradient, as Hooke's is: det F is nothing to it.
template <int Dim, class L>
bool is_linear(L const& law) {
  if constexpr (LawWithInternalVariables<L>) {
    return is_linear<Dim>(law.over(std::numeric_limits<double>::infinity())
                              .after(Vector<double, L::template internal_variables<Dim>>::zero()));
  } else if constexpr (LawPerElement<L>) {
    Vector<double, L::element_values> values;
    for (int k = 0; k < L::element_values; ++k) values[k] = 1 + 0.25 * k;
    return is_linear<Dim>(law.at(values));
  } else {
    auto h = Tensor<double, Dim>::zero();
    h(0, 0) = 0.3;
    h(0, 1) = 0.2;
    h(1, 0) = -0.1;
    h(1, 1) = -0.15;
    auto const once = stress(law, h), twice = stress(law, 2.0 * h);
    return norm(twice - 2.0 * once) <= 1e-12 * norm(twice);
  }
}

/// Calls visit(type name, number, least det F) for each element at displacements u, (nodes, dim), whose law is
/// not linear; or for all.
template <class Parts, class Visit>
void for_each_least_jacobian(Parts const& parts, Eigen::VectorXd const& u, bool all,
                             Visit const& visit) {
  constexpr int dim = Parts::dim;
  auto const& mesh = parts.state.topology->mesh();
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    bool linear[Table::groups];
    [&]<int... G>(std::integer_sequence<int, G...>) {
      ((linear[G] =
            is_linear<dim>(parts.template law_of<typename Table::template formulation<G>>())),
       ...);
    }(std::make_integer_sequence<int, Table::groups>());
    auto const tags = user_groups<E>(parts);
    auto const& elements = mesh.template elements<E>();
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (!all && linear[tags[e]]) continue;
      auto const rest = nodal(mesh, elements[e]);
      auto now = rest;
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < dim; ++k)
          now(a, k) += u[Eigen::Index{dim} * elements[e][static_cast<std::size_t>(a)] + k];
      double least = std::numeric_limits<double>::infinity();
      for (auto const& gradient : gradients_on_lattice<E>()) {
        double const j =
            determinant(transpose(now) * gradient) / determinant(transpose(rest) * gradient);
        least = j < least || std::isnan(j) ? j : least;
        if (std::isnan(j)) break;
      }
      visit(E::name(), static_cast<Index>(e), least);
    }
  });
}

template <class Parts>
LeastJacobian least_jacobian_at(Parts const& parts, Eigen::VectorXd const& u, bool all) {
  LeastJacobian found;
  for_each_least_jacobian(parts, u, all, [&](char const* element, Index e, double least) {
    if (least < found.value || std::isnan(least)) found = {least, element, e};
  });
  return found;
}

}  // namespace detail
}  // namespace pliant

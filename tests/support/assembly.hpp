#pragma once

#include <Eigen/Dense>

#include "support/flat.hpp"

// Dense matrices of a body: small bodies only.
namespace pliant::test {

/// The stiffness −∂F/∂u at u; rows and columns run over (node, direction).
template <class TheBody>
Eigen::MatrixXd assembled_stiffness(TheBody& body, FieldOf<TheBody::dim> const& u) {
  constexpr std::size_t dim = TheBody::dim;
  auto const n = static_cast<Eigen::Index>(dim * u.size());
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index column = 0; column < n; ++column) {
    FieldOf<dim> du(u.size());
    du[static_cast<std::size_t>(column) / dim][static_cast<std::size_t>(column) % dim] = 1;
    auto const df = flat<double>(tangent_product(body, u, du));
    k.col(column) = -Eigen::Map<Eigen::VectorXd const>(df.data(), n);
  }
  return k;
}

/// The squares of the angular frequencies, ascending, of a body linearised at u whose nodes move in
/// the directions for which moves(node, direction) holds.
template <class TheBody, class Moves>
Eigen::VectorXd squared_frequencies(TheBody& body, FieldOf<TheBody::dim> const& u,
                                    Moves const& moves) {
  constexpr std::size_t dim = TheBody::dim;
  Eigen::MatrixXd const k = assembled_stiffness(body, u);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < k.rows(); ++i)
    if (moves(static_cast<std::size_t>(i) / dim, static_cast<std::size_t>(i) % dim))
      free.push_back(i);
  auto const n = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i)
    scale[i] =
        1 /
        std::sqrt(
            body.parts()
                .layout
                .mass_list()[static_cast<std::size_t>(free[static_cast<std::size_t>(i)]) / dim]);
  Eigen::MatrixXd const a = scale.asDiagonal() * k(free, free) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace pliant::test

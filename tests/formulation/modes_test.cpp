#include <Eigen/Dense>

#include <pliant/law/hooke.hpp>
#include <pliant/solver/assemble.hpp>

#include "support/elements.hpp"
#include "support/formulations.hpp"

namespace pliant::test::modes_test {

/// The eigenvalues, ascending and over the largest, of the stiffness of one crooked element at rest.
template <class F>
Eigen::VectorXd spectrum() {
  using E = typename F::element;
  constexpr int n = F::nodes * F::dim;
  Random random(7);
  Nodal<E, double> rest;
  auto stretch = random.tensor<E::dim>(0.2);
  for (int i = 0; i < E::dim; ++i) stretch(i, i) += 1;
  for (int a = 0; a < E::nodes; ++a) {
    auto const x = stretch * E::place(a);
    for (int k = 0; k < E::dim; ++k)
      rest(a, k) = x[k] + (a < E::cell::corners && E::degree == 1 ? 0.1 * random() : 0.0);
  }
  auto const law = prepared<F>(Hooke<double>::from(soft));
  auto const k = stiffness<F>(law, rest, Nodal<E, double>::zero());
  Eigen::MatrixXd matrix(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) matrix(i, j) = (k(i, j) + k(j, i)) / 2;
  Eigen::VectorXd const values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  return values / values[n - 1];
}

template <class E, class Q>
void only_rigid_motions_are_free() {
  constexpr int rigid = E::dim == 2 ? 3 : 6;
  auto const values = spectrum<Formulation<E, Q, Hooke>>();
  INFO(E::name() << ", " << (Tabulation<E, Q, double>::count) << " points");
  for (int k = 0; k < rigid; ++k) CHECK(std::abs(values[k]) < 1e-13);
  CHECK(values[rigid] > 1e-4);
}

TEST_CASE("no deformation goes without resistance: full rules", "[formulation]") {
  only_rigid_motions_are_free<Tri3, Gauss<1>>();
  only_rigid_motions_are_free<Tri6, Gauss<4>>();
  only_rigid_motions_are_free<Quad4, Gauss<2>>();
  only_rigid_motions_are_free<Quad8, Gauss<3>>();
  only_rigid_motions_are_free<Quad9, Gauss<3>>();
  only_rigid_motions_are_free<Tet4, Gauss<1>>();
  only_rigid_motions_are_free<Tet10, Gauss<3>>();
  only_rigid_motions_are_free<Hex8, Gauss<2>>();
  only_rigid_motions_are_free<Hex20, Gauss<3>>();
  only_rigid_motions_are_free<Hex27, Gauss<3>>();
  only_rigid_motions_are_free<Wedge6, Gauss<2>>();
  only_rigid_motions_are_free<Pyramid5, Gauss<2>>();
}

TEST_CASE("no deformation goes without resistance: the least rules that are accepted",
          "[formulation]") {
  only_rigid_motions_are_free<Tri6, Gauss<2>>();
  only_rigid_motions_are_free<Tet10, Gauss<2>>();
  only_rigid_motions_are_free<Quad4, OnePoint>();
  only_rigid_motions_are_free<Hex8, OnePoint>();
  only_rigid_motions_are_free<Quad4, Lobatto<2>>();
  only_rigid_motions_are_free<Quad9, Lobatto<3>>();
  only_rigid_motions_are_free<Hex8, Lobatto<2>>();
  only_rigid_motions_are_free<Hex27, Lobatto<3>>();
}

TEST_CASE("no deformation goes without resistance: mean dilatation", "[formulation]") {
  only_rigid_motions_are_free<Quad4, FBar<Gauss<2>>>();
  only_rigid_motions_are_free<Hex8, FBar<Gauss<2>>>();
  only_rigid_motions_are_free<Tri6, FBar<Gauss<2>>>();
  only_rigid_motions_are_free<Quad8, FBar<Gauss<3>>>();
  only_rigid_motions_are_free<Quad9, FBar<Gauss<3>>>();
  only_rigid_motions_are_free<Hex20, FBar<Gauss<3>>>();
  only_rigid_motions_are_free<Hex27, FBar<Gauss<3>>>();
  // One quadratic tetrahedron is free to move conformally, b ↦ 2 (b·x) x − |x|² b; several are not.
  using F = Formulation<Tet10, FBar<Gauss<3>>, Hooke>;
  auto const alone = spectrum<F>();
  CHECK(alone[8] < 1e-13);
  CHECK(alone[9] > 1e-4);
  auto const mesh = mesh::box<Tet10>({.size = {2, 1, 1}, .cells = {2, 1, 1}});
  Body body{Reference<double>{}, mesh, soft, Group<F>{}};
  Eigen::VectorXd const u = Eigen::VectorXd::Zero(3 * body.nodes());
  auto const k = Eigen::MatrixXd(assemble(body, u).stiffness);
  Eigen::VectorXd const values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
  CHECK(values[5] < 1e-13 * values[values.size() - 1]);
  CHECK(values[6] > 1e-4 * values[values.size() - 1]);
}

TEST_CASE("over-integration changes nothing on straight cells", "[formulation]") {
  // Tri3 and Tet4 have one strain; more points see the same.
  CHECK((spectrum<Formulation<Tet4, Gauss<1>, Hooke>>() -
         spectrum<Formulation<Tet4, Gauss<3>, Hooke>>())
            .norm() < 1e-13);
  CHECK((spectrum<Formulation<Tet10, Gauss<3>, Hooke>>() -
         spectrum<Formulation<Tet10, Gauss<6>, Hooke>>())
            .norm() < 1e-13);
}

}  // namespace pliant::test::modes_test

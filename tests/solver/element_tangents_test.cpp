#include <Eigen/Dense>

#include <pliant/reference.hpp>
#include <pliant/solve.hpp>

#include "support/formulations.hpp"
#include "support/random.hpp"

// Tangents of elements without their negative eigenvalues, and what they do for Newton's method.
namespace pliant::test::element_tangents {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Softening = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

Eigen::MatrixXd random_symmetric(Eigen::Index size, unsigned seed) {
  Random random(seed);
  Eigen::MatrixXd a(size, size);
  for (double& x : a.reshaped()) x = random();
  return a + a.transpose();
}
double least_eigenvalue(Eigen::MatrixXd const& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues()[0];
}
Eigen::MatrixXd positive_part(Eigen::MatrixXd a) {
  detail::keep_positive_part(a);
  return a;
}

TEST_CASE("the positive part of a matrix has its positive eigenvalues alone", "[solver]") {
  for (unsigned seed : {1u, 2u, 3u}) {
    Eigen::MatrixXd const a = random_symmetric(9, seed);
    REQUIRE(least_eigenvalue(a) < -0.5);
    Eigen::MatrixXd const part = positive_part(a);
    CHECK(least_eigenvalue(part) > -1e-13);
    // What is taken away is semidefinite too, and they have no direction in common: the nearest (Higham 1988).
    CHECK(least_eigenvalue(part - a) > -1e-13);
    CHECK((part * (part - a)).norm() < 1e-13);
    CHECK((part - part.transpose()).norm() < 1e-14);
    CHECK(positive_part(a * a) == a * a);
  }
  CHECK(positive_part(-Eigen::MatrixXd::Identity(4, 4)).norm() < 1e-15);
  Eigen::MatrixXd broken = -Eigen::MatrixXd::Identity(4, 4);
  broken(1, 2) = NAN;
  CHECK(std::isnan(positive_part(broken)(1, 2)));
}

template <class TheBody>
Eigen::MatrixXd stiffness(TheBody const& body, ElementTangents tangents) {
  detail::AssembledBlocks<TheBody::dim> sum;
  detail::StaticProblem<TheBody> const problem(body);
  detail::assemble_into(sum, body.parts(), problem.start(), Assemble::stiffness,
                        std::numeric_limits<double>::infinity(), 1, tangents);
  return Eigen::MatrixXd(detail::by_scalars(sum.stiffness));
}

/// Pulls two nodes together, and pushes them apart along the other axis.
template <class T>
struct Saddle {
  static constexpr int nodes = 2, dim = 2;
  T stiffness;  // N/m
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 2, 2> const&, Matrix<S, 2, 2> const& u) const {
    return stiffness / 2 * (square(u(0, 0) - u(1, 0)) - square(u(0, 1) - u(1, 1)));
  }
};

TEST_CASE("each element is projected by itself, and what has no energy is not", "[solver]") {
  using enum ElementTangents;
  auto const mesh = mesh::rectangle({.size = {1, 0.5}, .cells = {2, 1}});
  auto body = body_of<Softening>(Reference<double>{}, mesh);
  auto single = body_of<Softening>(Reference<double>{},
                                   mesh::rectangle({.size = {0.5, 0.5}, .cells = {1, 1}}));
  auto const squeeze = [](auto& of, double by) {
    auto u = of.mesh().nodes;
    for (auto& x : u) x = {-by * x[0], 0.1 * by * x[0] * x[1]};
    of.set_displacements(u);
  };
  CHECK(stiffness(body, exact) == stiffness(body, positive_semidefinite));
  squeeze(body, 0.6);
  squeeze(single, 0.6);
  Eigen::MatrixXd const plain = stiffness(single, exact);
  double const size = plain.norm();
  CHECK(least_eigenvalue(plain) < -0.1 * size);
  CHECK((stiffness(single, positive_semidefinite) - positive_part(plain)).norm() < 1e-13 * size);
  Eigen::MatrixXd const projected = stiffness(body, positive_semidefinite);
  CHECK(least_eigenvalue(stiffness(body, exact)) < -0.1 * size);
  CHECK(least_eigenvalue(projected) > -1e-13 * size);
  CHECK((projected - positive_part(stiffness(body, exact))).norm() > 1e-3 * size);

  body.add(std::vector<std::array<Index, 2>>{{0, 5}}, Saddle<double>{0.3});
  Eigen::MatrixXd const added = stiffness(body, positive_semidefinite) - projected;
  Eigen::MatrixXd spring = Eigen::MatrixXd::Zero(12, 12);
  spring(0, 0) = spring(10, 10) = 0.3;
  spring(0, 10) = spring(10, 0) = -0.3;
  CHECK((added - spring).norm() < 1e-13);

  Eigen::MatrixXd const before[] = {stiffness(body, exact), stiffness(body, positive_semidefinite)};
  body.press(mesh.boundary("right"), 0.7);
  Eigen::MatrixXd const pressures = stiffness(body, exact) - before[0];
  CHECK(pressures.norm() > 0.1);
  CHECK((stiffness(body, positive_semidefinite) - before[1] - pressures).norm() < 1e-13);
}

template <class F>
NewtonReport from_squeezed(double by, ElementTangents tangents) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {12, 3}});
  auto body = body_of<F>(Reference<double>{}, mesh);
  body.clamp(mesh.boundary("left"));
  auto u = Random(1).field<2>(mesh.nodes.size(), 0.02);
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i][0] -= by * mesh.nodes[i][0];
    if (mesh.nodes[i][0] == 0) u[i] = {};
  }
  body.set_displacements(u);
  body.set_load(nodes_of(mesh.boundary("right"))[0], {0.003, 0.002});
  return solve_static(body, {.load_halvings = 0, .tolerance = 1e-9, .tangents = tangents});
}
template <class F>
void check_squeezed(double by) {
  using enum ElementTangents;
  CHECK_THROWS_WITH(from_squeezed<F>(by, exact), says("no convergence"));
  auto const found = from_squeezed<F>(by, positive_semidefinite);
  CHECK(found.iterations <= 30);
  CHECK_FALSE(found.indefinite);
  CHECK(found.energy == Approx(from_squeezed<F>(0, exact).energy).epsilon(1e-6));
}

TEST_CASE("projected tangents lead to rest from where exact ones do not", "[solver]") {
  check_squeezed<Rubber>(0.5);
  check_squeezed<Softening>(0.3);
}

TEST_CASE("tangents are exact unless asked, and projected where they are assembled", "[solver]") {
  CHECK(NewtonOptions{}.tangents == ElementTangents::exact);
  auto body =
      body_of<Rubber>(Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}));
  body.clamp(body.mesh().boundary("left"));
  CHECK_THROWS_WITH(solve_static(body, {.linear = LinearMethod::matrix_free,
                                        .tangents = ElementTangents::positive_semidefinite}),
                    says("projected where they are assembled"));
}

}  // namespace pliant::test::element_tangents

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/Eigenvalues>

#include <pliant/formulation/one_gradient.hpp>

#include "support/formulations.hpp"
#include "support/random.hpp"

// Stiffness matrices of elements beside products of their tangents, column by column.
namespace pliant::test::stiffness_test {

/// An element of a distorted mesh, and displacements at random.
template <class F>
struct Deformed {
  using E = typename F::element;
  typename F::template law<double> law;
  Nodal<E, double> rest, u;

  explicit Deformed(Elastic const& material, Index number = 0)
      : law(F::template law<double>::from(material)) {
    auto const mesh = distorted_mesh<E>(2);
    rest = nodal(mesh, mesh.template elements<E>().at(static_cast<std::size_t>(number)));
    Random random(1 + static_cast<unsigned>(number));
    for (int a = 0; a < F::nodes; ++a)
      for (int i = 0; i < F::dim; ++i) u(a, i) = 0.03 * random();
  }
};

template <class F>
void check_columns(Elastic const& material) {
  using E = typename F::element;
  constexpr int size = F::nodes * F::dim;
  auto const [law, rest, u] = Deformed<F>(material);

  auto const k = stiffness<F>(law, rest, u);

  double largest = 0, off = 0, skew = 0;
  for (int column = 0; column < size; ++column) {
    auto du = Nodal<E, double>::zero();
    du(column / F::dim, column % F::dim) = 1;
    auto const df = tangent_product<F>(law, rest, u, du);
    for (int row = 0; row < size; ++row) {
      double const entry = -df(row / F::dim, row % F::dim);
      largest = std::max(largest, std::abs(entry));
      off = std::max(off, std::abs(k(row, column) - entry));
      skew = std::max(skew, std::abs(k(row, column) - k(column, row)));
    }
  }
  INFO(E::name());
  CHECK(off < 1e-13 * largest);
  CHECK(skew == 0);
}

TEST_CASE("the stiffness under a mean dilatation has its tangent products as columns",
          "[formulation]") {
  Elastic const rubber{2e6, 0.49, 1e3};
  check_columns<Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>>(rubber);
  check_columns<Formulation<Quad9, FBar<Gauss<3>>, NeoHookean>>(rubber);
  check_columns<Formulation<Tet10, FBar<Gauss<3>>, NeoHookean>>(rubber);
  check_columns<Formulation<Hex8, FBar<Gauss<2>>, MooneyRivlin>>(rubber);
  check_columns<Formulation<Hex27, FBar<Gauss<3>>, NeoHookean>>(rubber);
  check_columns<Formulation<Hex27, FBar<Gauss<3>>, Hooke>>(rubber);
}

/// Of an element that looks at one gradient: row sums, and eigenvalues but for zeros, without the matrix.
template <class F>
void check_one_gradient(Elastic const& material) {
  static_assert(has_one_gradient<F>);
  constexpr int size = F::nodes * F::dim, few = F::dim * F::dim;
  for (Index e = 0; e < 4; ++e) {
    auto const [law, rest, u] = Deformed<F>(material, e);
    auto const entries = stiffness<F>(law, rest, u);
    Eigen::Matrix<double, size, size> k;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) k(i, j) = entries(i, j);
    double const largest = k.cwiseAbs().maxCoeff();
    Eigen::VectorXd wanted = k.template selfadjointView<Eigen::Lower>().eigenvalues();
    std::ranges::sort(wanted, std::ranges::greater{}, [](double x) { return std::abs(x); });

    auto const one = one_gradient<F>(law, rest, u);

    auto const rows = one.row_sums();
    for (int i = 0; i < size; ++i)
      CHECK(rows(i / F::dim, i % F::dim) == Approx(k.row(i).cwiseAbs().sum()).epsilon(1e-12));
    double const factor = 3;
    auto const half = one.of_gradients(factor);
    Eigen::Matrix<double, few, few> reduced;
    for (int i = 0; i < few; ++i)
      for (int j = i; j < few; ++j) reduced(j, i) = half(i, j);
    Eigen::VectorXd found = reduced.template selfadjointView<Eigen::Lower>().eigenvalues();
    std::ranges::sort(found, std::ranges::greater{}, [](double x) { return std::abs(x); });
    for (int i = 0; i < few; ++i)
      CHECK(std::abs(found[i] / factor - wanted[i]) < 1e-13 * size * largest);
    for (int i = few; i < size; ++i) CHECK(std::abs(wanted[i]) < 1e-13 * size * largest);
  }
}

TEST_CASE("an element with one gradient tells row sums and eigenvalues without its stiffness",
          "[formulation]") {
  Elastic const rubber{2e6, 0.45, 1e3};
  check_one_gradient<Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>>(rubber);
  check_one_gradient<Formulation<Tri3, Gauss<1>, NeoHookean>>(rubber);
  check_one_gradient<Formulation<Tet4, Gauss<1>, Hooke>>(rubber);
  check_one_gradient<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>>(rubber);
  check_one_gradient<Formulation<Tet4, Gauss<1>, MooneyRivlin>>(rubber);
}

}  // namespace pliant::test::stiffness_test

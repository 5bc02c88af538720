#include "support/formulations.hpp"
#include "support/random.hpp"

// Stiffness matrices of elements beside products of their tangents, column by column.
namespace pliant::test::stiffness_test {

template <class F>
void check_columns(Elastic const& material) {
  using E = typename F::element;
  constexpr int size = F::nodes * F::dim;
  auto const law = F::template law<double>::from(material);
  auto const mesh = distorted_mesh<E>(2);
  auto const rest = nodal(mesh, mesh.template elements<E>()[0]);
  Random random(1);
  Nodal<E, double> u;
  for (int a = 0; a < F::nodes; ++a)
    for (int i = 0; i < F::dim; ++i) u(a, i) = 0.03 * random();

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

}  // namespace pliant::test::stiffness_test

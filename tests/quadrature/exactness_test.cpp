#include <pliant/element/linear.hpp>
#include <pliant/quadrature/by_need.hpp>
#include <pliant/quadrature/lobatto.hpp>

#include "support/catch.hpp"

namespace pliant::test::exactness_test {

static_assert(QuadratureOn<Gauss<1>, Triangle> && QuadratureOn<Gauss<6>, Triangle>);
static_assert(QuadratureOn<Gauss<1>, Tetrahedron> && QuadratureOn<Gauss<6>, Tetrahedron>);
static_assert(QuadratureOn<Gauss<4>, Quadrilateral> && QuadratureOn<Gauss<4>, Hexahedron>);
static_assert(QuadratureOn<Gauss<2>, Wedge> && QuadratureOn<Gauss<2>, Pyramid>);
static_assert(QuadratureOn<Lobatto<3>, Hexahedron> && !QuadratureOn<int, Triangle>);

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }
double over_line(int p) { return p % 2 ? 0 : 2.0 / (p + 1); }
double over_triangle(int a, int b) { return factorial(a) * factorial(b) / factorial(a + b + 2); }

/// ∫ x^a y^b z^c over the cell.
template <class Cell>
double integral(std::array<int, 3> const& p) {
  auto const [a, b, c] = p;
  if constexpr (std::same_as<Cell, Triangle>) return over_triangle(a, b);
  if constexpr (std::same_as<Cell, Tetrahedron>)
    return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
  if constexpr (std::same_as<Cell, Wedge>) return over_triangle(a, b) * over_line(c);
  if constexpr (std::same_as<Cell, Pyramid>)  // the square at z has the half edge 1 − z
    return over_line(a) * over_line(b) * factorial(c) * factorial(a + b + 2) /
           factorial(a + b + c + 3);
  return over_line(a) * over_line(b) * (Cell::dim == 3 ? over_line(c) : 1);
}
template <class Cell, class Q>
double by_rule(std::array<int, 3> const& p) {
  constexpr auto rule = Q::template rule<Cell>();
  double sum = 0;
  for (int q = 0; q < rule.count; ++q) {
    double value = rule.weights[q];
    for (int k = 0; k < Cell::dim; ++k)
      value *= std::pow(rule.points[q][k], p[static_cast<std::size_t>(k)]);
    sum += value;
  }
  return sum;
}
/// The largest error over all monomials of a degree: the largest per direction on tensor cells, total
/// on the others.
template <class Cell, class Q>
double error(int degree) {
  double largest = 0;
  int const z = Cell::dim == 3 ? degree : 0;
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; b <= degree; ++b)
      for (int c = 0; c <= z; ++c) {
        bool const belongs = TensorCell<Cell> ? std::max({a, b, c}) == degree : a + b + c == degree;
        if (belongs)
          largest =
              std::max(largest, std::abs(by_rule<Cell, Q>({a, b, c}) - integral<Cell>({a, b, c})));
      }
  return largest;
}

enum class Points { inside, on_the_boundary_too };

template <class Cell, class Q, Points Where = Points::inside>
void check_rule(int count, int degree) {
  constexpr auto rule = Q::template rule<Cell>();
  INFO("cell with " << Cell::dim << " dimensions and " << Cell::corners << " corners, "
                    << rule.count << " points");
  CHECK(rule.count == count);
  // Adding n terms rounds n times, each time by at most half a unit in the last place of the volume.
  double const rounding =
      rule.count * std::numeric_limits<double>::epsilon() * std::max(Cell::volume, 0.5);
  for (int d = 0; d <= degree; ++d) {
    INFO("degree " << d);
    CHECK((error<Cell, Q>(d)) < rounding);
  }
  CHECK((error<Cell, Q>(degree + 1)) > 1e-7);
  double const edge = Where == Points::inside ? 0 : -1e-15;
  for (int q = 0; q < rule.count; ++q) {
    CHECK(rule.weights[q] > 0);
    Vector<double, Cell::dim> xi;
    for (int k = 0; k < Cell::dim; ++k) xi[k] = rule.points[q][k];
    auto const l = Cell::linear(xi);  // positive inside
    for (int a = 0; a < Cell::corners; ++a) CHECK(l[a] > edge);
  }
}

TEST_CASE("Gauss rules are exact to their degree and no further", "[quadrature]") {
  SECTION("triangles: degree n") {
    check_rule<Triangle, Gauss<1>>(1, 1);
    check_rule<Triangle, Gauss<2>>(3, 2);
    check_rule<Triangle, Gauss<3>>(6, 4);  // the rule of degree 4
    check_rule<Triangle, Gauss<4>>(6, 4);
    check_rule<Triangle, Gauss<5>>(7, 5);
    check_rule<Triangle, Gauss<6>>(12, 6);
  }
  SECTION("tetrahedra: degree n") {
    check_rule<Tetrahedron, Gauss<1>>(1, 1);
    check_rule<Tetrahedron, Gauss<2>>(4, 2);
    check_rule<Tetrahedron, Gauss<3>>(14, 5);  // the rule of degree 5
    check_rule<Tetrahedron, Gauss<5>>(14, 5);
    check_rule<Tetrahedron, Gauss<6>>(24, 6);
  }
  SECTION("quadrilaterals and hexahedra: degree 2n - 1 in each direction") {
    check_rule<Quadrilateral, Gauss<1>>(1, 1);
    check_rule<Quadrilateral, Gauss<2>>(4, 3);
    check_rule<Quadrilateral, Gauss<3>>(9, 5);
    check_rule<Quadrilateral, Gauss<4>>(16, 7);
    check_rule<Quadrilateral, Gauss<5>>(25, 9);
    check_rule<Hexahedron, Gauss<1>>(1, 1);
    check_rule<Hexahedron, Gauss<2>>(8, 3);
    check_rule<Hexahedron, Gauss<3>>(27, 5);
    check_rule<Hexahedron, Gauss<4>>(64, 7);
  }
  SECTION("wedges: that of triangles, and degree 2n - 1 along the axis") {
    check_rule<Wedge, Gauss<1>>(1, 1);
    check_rule<Wedge, Gauss<2>>(6, 2);
    check_rule<Wedge, Gauss<3>>(18, 4);
  }
  SECTION("pyramids: degree 2n - 1") {
    check_rule<Pyramid, Gauss<1>>(1, 1);
    check_rule<Pyramid, Gauss<2>>(8, 3);
    check_rule<Pyramid, Gauss<3>>(27, 5);
  }
}

TEST_CASE("Gauss rules of more points have the known abscissae", "[quadrature]") {
  // Abramowitz and Stegun, table 25.4.
  constexpr auto four = detail::gauss_jacobi<4>();
  CHECK(four.points[3][0] == Approx(0.861136311594052575224).epsilon(2e-16));
  CHECK(four.weights[0] == Approx(0.347854845137453857373).epsilon(1e-15));
  constexpr auto ten = detail::gauss_jacobi<10>();
  CHECK(ten.points[9][0] == Approx(0.973906528517171720078).epsilon(2e-16));
  CHECK(ten.weights[9] == Approx(0.066671344308688137594).epsilon(1e-14));
}

TEST_CASE("Lobatto rules have the ends among their points, and degree 2n - 3", "[quadrature]") {
  check_rule<Quadrilateral, Lobatto<2>, Points::on_the_boundary_too>(4, 1);
  check_rule<Quadrilateral, Lobatto<3>, Points::on_the_boundary_too>(9, 3);
  check_rule<Quadrilateral, Lobatto<4>, Points::on_the_boundary_too>(16, 5);
  check_rule<Hexahedron, Lobatto<3>, Points::on_the_boundary_too>(27, 3);
  constexpr auto five = detail::gauss_lobatto<5>();
  CHECK(five.points[0][0] == -1);
  CHECK(five.points[3][0] == Approx(std::sqrt(3.0 / 7)).epsilon(4e-16));
  CHECK(five.weights[2] == Approx(32.0 / 45).epsilon(1e-15));
}

TEST_CASE("rules are found by the degree that they must be exact for, and by their size",
          "[quadrature]") {
  check_rule<Quadrilateral, Exact<3>>(4, 3);
  check_rule<Hexahedron, Exact<4>>(27, 5);
  check_rule<Triangle, Exact<5>>(7, 5);
  check_rule<Wedge, Exact<4>>(18, 4);
  check_rule<Pyramid, Exact<2>>(8, 3);
  check_rule<Tetrahedron, pliant::Points<14>>(14, 5);
  check_rule<Hexahedron, pliant::Points<8>>(8, 3);
  check_rule<Wedge, pliant::Points<6>>(6, 2);
}

TEST_CASE("a tabulation holds the element's values at the rule's points", "[quadrature]") {
  constexpr auto table = tabulate<Hex8, Gauss<2>, double>();
  constexpr auto rule = Gauss<2>::rule<Hexahedron>();
  for (int q = 0; q < rule.count; ++q) {
    Vector<double, 3> xi;
    for (int k = 0; k < 3; ++k) xi[k] = rule.points[q][k];
    for (int a = 0; a < 8; ++a) {
      CHECK(table.shape[q][a] == Hex8::shape(xi)[a]);
      for (int k = 0; k < 3; ++k) CHECK(table.gradient[q][a][k] == shape_gradient<Hex8>(xi)(a, k));
    }
    CHECK(table.weight[q] == rule.weights[q]);
  }
}

}  // namespace pliant::test::exactness_test

#include <pliant/element/simplex.hpp>
#include <pliant/element/tensor.hpp>
#include <pliant/quadrature/gauss.hpp>

#include "support/catch.hpp"

namespace pliant::test {

static_assert(QuadratureOn<Gauss<1>, Triangle> && QuadratureOn<Gauss<4>, Triangle>);
static_assert(QuadratureOn<Gauss<1>, Tetrahedron> && QuadratureOn<Gauss<5>, Tetrahedron>);
static_assert(QuadratureOn<Gauss<4>, Quadrilateral> && QuadratureOn<Gauss<4>, Hexahedron>);
static_assert(!QuadratureOn<int, Triangle>);

template <class Cell>
constexpr bool is_simplex = std::same_as<Cell, Triangle> || std::same_as<Cell, Tetrahedron>;

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

/// ∫ x^a y^b z^c over the cell: a! b! c!/(a + b + c + d)! on a simplex, a product on a tensor cell.
template <class Cell>
double integral(std::array<int, 3> const& p) {
  if constexpr (is_simplex<Cell>)
    return factorial(p[0]) * factorial(p[1]) * factorial(p[2]) /
           factorial(p[0] + p[1] + p[2] + Cell::dim);
  double product = 1;
  for (std::size_t k = 0; k < Cell::dim; ++k) product *= p[k] % 2 ? 0 : 2.0 / (p[k] + 1);
  return product;
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
/// The largest error over all monomials of a degree: total on simplices, largest per direction on
/// tensor cells.
template <class Cell, class Q>
double error(int degree) {
  double largest = 0;
  int const z = Cell::dim == 3 ? degree : 0;
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; b <= degree; ++b)
      for (int c = 0; c <= z; ++c) {
        bool const belongs = is_simplex<Cell> ? a + b + c == degree : std::max({a, b, c}) == degree;
        if (belongs)
          largest =
              std::max(largest, std::abs(by_rule<Cell, Q>({a, b, c}) - integral<Cell>({a, b, c})));
      }
  return largest;
}

template <class Cell, class Q>
void check_rule(int degree) {
  constexpr auto rule = Q::template rule<Cell>();
  INFO("cell with " << Cell::dim << " dimensions, " << rule.count << " points");
  // Adding n terms rounds n times, each time by at most half a unit in the last place of the volume.
  double const rounding = rule.count * std::numeric_limits<double>::epsilon() *
                          std::max(integral<Cell>({0, 0, 0}), 0.5);
  for (int d = 0; d <= degree; ++d) {
    INFO("degree " << d);
    CHECK((error<Cell, Q>(d)) < rounding);
  }
  CHECK((error<Cell, Q>(degree + 1)) > 1e-5);
  for (int q = 0; q < rule.count; ++q) {
    CHECK(rule.weights[q] > 0);
    double sum = 0;
    for (double x : rule.points[q]) {
      CHECK(x > (is_simplex<Cell> ? 0 : -1));
      CHECK(x < 1);
      sum += x;
    }
    if (is_simplex<Cell>) CHECK(sum < 1);
  }
}

TEST_CASE("Gauss rules are exact to their degree and no further", "[quadrature]") {
  SECTION("triangles: degree n") {
    check_rule<Triangle, Gauss<1>>(1);
    check_rule<Triangle, Gauss<2>>(2);
    check_rule<Triangle, Gauss<3>>(4);  // the rule of degree 4
    check_rule<Triangle, Gauss<4>>(4);
  }
  SECTION("tetrahedra: degree n") {
    check_rule<Tetrahedron, Gauss<1>>(1);
    check_rule<Tetrahedron, Gauss<2>>(2);
    check_rule<Tetrahedron, Gauss<3>>(5);  // the rule of degree 5
    check_rule<Tetrahedron, Gauss<5>>(5);
  }
  SECTION("quadrilaterals and hexahedra: degree 2n - 1 in each direction") {
    check_rule<Quadrilateral, Gauss<1>>(1);
    check_rule<Quadrilateral, Gauss<2>>(3);
    check_rule<Quadrilateral, Gauss<3>>(5);
    check_rule<Quadrilateral, Gauss<4>>(7);
    check_rule<Hexahedron, Gauss<1>>(1);
    check_rule<Hexahedron, Gauss<2>>(3);
    check_rule<Hexahedron, Gauss<3>>(5);
    check_rule<Hexahedron, Gauss<4>>(7);
  }
}

TEST_CASE("rules have as many points as they say", "[quadrature]") {
  CHECK(Gauss<2>::rule<Triangle>().count == 3);
  CHECK(Gauss<2>::rule<Tetrahedron>().count == 4);
  CHECK(Gauss<3>::rule<Quadrilateral>().count == 9);
  CHECK(Gauss<2>::rule<Hexahedron>().count == 8);
}

TEST_CASE("a tabulation holds the element's values at the rule's points", "[quadrature]") {
  constexpr auto table = tabulate<Hex8, Gauss<2>, double>();
  constexpr auto rule = Gauss<2>::rule<Hexahedron>();
  for (int q = 0; q < rule.count; ++q) {
    Vector<double, 3> xi;
    for (int k = 0; k < 3; ++k) xi[k] = rule.points[q][k];
    for (int a = 0; a < 8; ++a) {
      CHECK(table.shape[q][a] == Hex8::shape(xi)[a]);
      for (int k = 0; k < 3; ++k) CHECK(table.gradient[q][a][k] == Hex8::gradient(xi)(a, k));
    }
    CHECK(table.weight[q] == rule.weights[q]);
  }
}

}  // namespace pliant::test

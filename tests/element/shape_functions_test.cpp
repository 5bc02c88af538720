#include "support/catch.hpp"
#include "support/difference_quotient.hpp"
#include "support/elements.hpp"
#include "support/random.hpp"

namespace pliant::test::shape_functions_test {

static_assert(Element<Tri3> && Element<Tri6> && Element<Quad4> && Element<Quad8> && Element<Quad9>);
static_assert(Element<Tet4> && Element<Tet10> && Element<Hex8> && Element<Hex20> && Element<Hex27>);
static_assert(Element<Wedge6> && Element<Pyramid5> && !Element<Triangle> && !Element<int>);
static_assert(LinearSimplex<Tri3> && LinearSimplex<Tet4> && !LinearSimplex<Tri6>);
static_assert(Multilinear<Quad4> && Multilinear<Hex8> && !Multilinear<Quad8> && !Multilinear<Tet4>);
static_assert(CurvedSimplex<Tri6> && CurvedSimplex<Tet10> && !CurvedSimplex<Tri3>);

/// Any point near the middle of the cell, inside or out.
template <class E>
Vector<double, E::dim> random_point(Random& random) {
  auto xi = middle_of<typename E::cell>();
  for (int k = 0; k < E::dim; ++k) xi[k] += 0.5 * random();
  return xi;
}

TEST_CASE("nodes lie where the formats that others read have them", "[element]") {
  auto const is_at = [](auto const& place, std::initializer_list<double> there) {
    int k = 0;
    for (double x : there) CHECK(place[k++] == x);
  };
  is_at(Tri6::place(4), {0.5, 0.5});
  is_at(Tet10::place(6), {0, 0.5, 0});
  is_at(Tet10::place(9), {0, 0.5, 0.5});
  is_at(Quad8::place(5), {1, 0});
  is_at(Quad9::place(8), {0, 0});
  is_at(Hex20::place(11), {-1, 0, -1});
  is_at(Hex20::place(16), {-1, -1, 0});
  is_at(Hex27::place(20), {-1, 0, 0});
  is_at(Hex27::place(25), {0, 0, 1});
  is_at(Hex27::place(26), {0, 0, 0});
}

TEMPLATE_TEST_CASE("shape functions are one at their node and zero at the others", "[element]",
                   ALL_ELEMENTS) {
  for (int b = 0; b < TestType::nodes; ++b) {
    auto const n = TestType::shape(TestType::place(b));
    for (int a = 0; a < TestType::nodes; ++a) CHECK(n[a] == (a == b ? 1 : 0));
  }
}

TEMPLATE_TEST_CASE("shape functions add up to one and carry all polynomials of their degree",
                   "[element]", ALL_ELEMENTS) {
  Random random;
  for (int point = 0; point < 20; ++point) {
    auto const xi = random_point<TestType>(random);
    // (c + d·ξ)^degree
    auto const d = random_point<TestType>(random);
    auto const polynomial = [&](Vector<double, TestType::dim> const& x) {
      return std::pow(0.3 + dot(d, x), TestType::degree);
    };
    auto const n = TestType::shape(xi);
    double sum = 0, carried = 0;
    auto position = Vector<double, TestType::dim>::zero();
    for (int a = 0; a < TestType::nodes; ++a) {
      sum += n[a];
      position = position + n[a] * TestType::place(a);
      carried += n[a] * polynomial(TestType::place(a));
    }
    CHECK(sum == Approx(1).epsilon(4e-15));
    CHECK(norm(position - xi) < 4e-15);
    CHECK(carried == Approx(polynomial(xi)).epsilon(0).margin(2e-14));
  }
}

TEMPLATE_TEST_CASE("gradients are the derivatives of the shape functions", "[element]",
                   ALL_ELEMENTS) {
  Random random;
  for (int point = 0; point < 20; ++point) {
    auto const xi = random_point<TestType>(random);
    auto const gradient = shape_gradient<TestType>(xi);
    for (int k = 0; k < TestType::dim; ++k)
      for (int a = 0; a < TestType::nodes; ++a) {
        auto const slope = derivative(
            [&](double h) {
              auto x = xi;
              x[k] += h;
              return TestType::shape(x)[a];
            },
            1e-2);
        // Rational shape functions are no polynomials of low degree, for which the quotient is exact.
        CHECK(gradient(a, k) ==
              Approx(slope).epsilon(0).margin(std::same_as<TestType, Pyramid5> ? 1e-7 : 1e-12));
      }
  }
}

TEMPLATE_TEST_CASE("a field is continuous: on a side only its nodes count", "[element]",
                   ALL_ELEMENTS) {
  using Cell = typename TestType::cell;
  Random random;
  for (auto const& side : Cell::sides()) {
    auto on_side = Vector<double, Cell::dim>::zero();
    double total = 0;
    std::vector<double> share;
    for (int corner : side) {
      share.push_back(corner >= 0 ? 1.1 + random() : 0);
      total += share.back();
    }
    for (std::size_t c = 0; c < side.size(); ++c)
      if (side[c] >= 0) on_side = on_side + share[c] / total * Cell::corner(side[c]);
    auto const n = TestType::shape(on_side);
    int counting = 0;
    for (int a = 0; a < TestType::nodes; ++a) {
      auto const l = Cell::linear(TestType::place(a));
      double belongs = 0;
      for (int corner : side)
        if (corner >= 0) belongs += l[corner];
      if (belongs < 0.999)
        CHECK(n[a] == Approx(0).margin(1e-15));
      else
        ++counting;
    }
    CHECK(counting >= Cell::dim);
  }
}

}  // namespace pliant::test::shape_functions_test

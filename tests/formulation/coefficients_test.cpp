#include <pliant/formulation/points.hpp>
#include <pliant/quadrature/corners.hpp>
#include <pliant/quadrature/gauss.hpp>
#include <pliant/quadrature/lobatto.hpp>

#include "support/catch.hpp"
#include "support/elements.hpp"
#include "support/random.hpp"

namespace pliant::test::coefficients_test {

/// The bilinear quadrilateral without what marks it as one: the general basis.
struct General : ElementOn<Quadrilateral, 4, 1> {
  static constexpr char const* name() { return "General"; }
  template <class S>
  static constexpr auto shape(Vector<S, 2> const& xi) {
    return Quad4::shape(xi);
  }
};
static_assert(Multilinear<Quad4> && Multilinear<Hex8>);
static_assert(!Multilinear<Tri3> && !Multilinear<Tet4> && !Multilinear<General>);

template <class E>
Nodal<E, double> random_values(Random& random) {
  Nodal<E, double> v;
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < E::dim; ++i) v(a, i) = random();
  return v;
}

/// The element's ∂v_i/∂ξ_k at a point of a rule, as the shape functions have it.
template <class E>
Tensor<double, E::dim> plain_gradient(Nodal<E, double> const& v, double const* point) {
  Vector<double, E::dim> xi;
  for (int k = 0; k < E::dim; ++k) xi[k] = point[k];
  return transpose(v) * shape_gradient<E>(xi);
}

TEMPLATE_TEST_CASE("coefficients give the gradient that the shape functions give", "[formulation]",
                   ALL_ELEMENTS, General) {
  using E = TestType;
  constexpr auto rule = Gauss<2>::rule<typename E::cell>();
  constexpr auto table = tabulate<E, Gauss<2>, double>();
  Random random;
  auto const v = random_values<E>(random);
  auto const coefficients = Coefficients<E, double>::of(v);
  for (int q = 0; q < rule.count; ++q)
    CHECK(norm(coefficients.gradient(table, q) - plain_gradient<E>(v, rule.points[q])) < 1e-14);
}

TEMPLATE_TEST_CASE("the divergence is the transpose of the gradient", "[formulation]", ALL_ELEMENTS,
                   General) {
  using E = TestType;
  constexpr auto rule = Gauss<2>::rule<typename E::cell>();
  constexpr auto table = tabulate<E, Gauss<2>, double>();
  Random random;
  auto const v = random_values<E>(random);
  auto sums = Coefficients<E, double>::zero();
  double work = 0;
  for (int q = 0; q < rule.count; ++q) {
    auto const t = random.tensor<E::dim>(1);
    sums.add_divergence(t, table, q);
    work += dot(t, plain_gradient<E>(v, rule.points[q]));
  }
  CHECK(dot(sums.per_node(), v) == Approx(work).epsilon(1e-13));
}

TEMPLATE_TEST_CASE("where an element lies is not rounded into its gradients", "[formulation]", Tri3,
                   Tet4, Tri6, Tet10, Quad4, Hex8, General) {
  using E = TestType;
  constexpr auto table = tabulate<E, Gauss<2>, double>();
  Random random;
  Nodal<E, double> near, far;
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < E::dim; ++i) {
      near(a, i) = std::round(1024 * random()) / 1024;
      far(a, i) = near(a, i) + 1048576;  // exact
    }
  for (int q = 0; q < table.count; ++q)
    CHECK(norm(Coefficients<E, double>::of(near).gradient(table, q) -
               Coefficients<E, double>::of(far).gradient(table, q)) == 0);
}

TEMPLATE_TEST_CASE("gradients in rest space are those of a linear field", "[formulation]",
                   ALL_ELEMENTS, General) {
  using E = TestType;
  constexpr auto table = tabulate<E, Gauss<2>, double>();
  Random random;
  Nodal<E, double> rest;
  for (int a = 0; a < E::nodes; ++a)  // the reference nodes, moved
    for (int i = 0; i < E::dim; ++i) {
      rest(a, i) = E::place(a)[i];
      rest(a, i) += 0.1 * random();
    }
  auto const h = random.tensor<E::dim>(1);
  Nodal<E, double> const u = rest * transpose(h);
  for (int q = 0; q < table.count; ++q) {
    auto const map = RestMap<E, double>::at(Coefficients<E, double>::of(rest), table, q);
    CHECK(norm(map.gradient(Coefficients<E, double>::of(u), table, q) - h) < 1e-14);
  }
}

static_assert(TensorElement<Quad4> && TensorElement<Hex8> && TensorElement<Quad8> &&
              TensorElement<Quad9> && TensorElement<Hex20> && TensorElement<Hex27>);
static_assert(!TensorElement<Tet10> && !TensorElement<Wedge6> && !TensorElement<General>);

template <class Q, class Cell>
constexpr int per_direction = points_per_direction(Q::template rule<Cell>());
static_assert(per_direction<Gauss<3>, Hexahedron> == 3 && per_direction<Gauss<1>, Hexahedron> == 1);
static_assert(per_direction<Lobatto<4>, Quadrilateral> == 4);
static_assert(per_direction<Corners, Quadrilateral> == 0);  // 2 by 2, in another order
static_assert(!is_tensor_rule<Gauss<2>, Wedge>);

/// An element's nodes on the cell, moved.
template <class E>
Nodal<E, double> moved_nodes(Random& random) {
  Nodal<E, double> x;
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < E::dim; ++i) x(a, i) = E::place(a)[i] + 0.05 * random();
  return x;
}
template <class E, class Q>
void compare_with_each_point() {
  constexpr auto table = tabulate<E, Q, double>();
  Random random;
  auto const x = Coefficients<E, double>::of(moved_nodes<E>(random)),
             u = Coefficients<E, double>::of(random_values<E>(random)),
             v = Coefficients<E, double>::of(random_values<E>(random));
  int visited = 0;
  visit_points<Q>(
      [&](int q, double weight, auto const& map, auto const& h, auto const& g) {
        CHECK(q == visited++);
        CHECK(weight == table.weight[q]);
        auto const alone = RestMap<E, double>::at(x, table, q);
        CHECK(map.volume == Approx(alone.volume).epsilon(1e-13));
        CHECK(norm(map.cofactors - alone.cofactors) < 1e-13);
        CHECK(norm(h - alone.gradient(u, table, q)) < 1e-13);
        CHECK(norm(g - alone.gradient(v, table, q)) < 1e-13);
      },
      x, u, v);
  CHECK(visited == table.count);

  auto sum = Coefficients<E, double>::zero(), expected = sum;
  auto const flux = [&](int q, double weight, auto const& map, auto const& h) {
    return (1.0 + q) * weight * (h * map.cofactors);
  };
  add_divergences<Q>(sum, flux, x, u);
  for (int q = 0; q < table.count; ++q) {
    auto const map = RestMap<E, double>::at(x, table, q);
    expected.add_divergence(flux(q, table.weight[q], map, map.gradient(u, table, q)), table, q);
  }
  auto const f = sum.per_node(), g = expected.per_node();
  CHECK(norm(f - g) < 1e-12 * norm(g));
}

TEMPLATE_TEST_CASE("sums over all points are those over each point alone", "[formulation]",
                   ALL_ELEMENTS, General) {
  compare_with_each_point<TestType, Gauss<2>>();
  compare_with_each_point<TestType, Gauss<3>>();
}
TEMPLATE_TEST_CASE("so are sums over rules of other points", "[formulation]", Quad4, Quad8, Quad9,
                   Hex8, Hex20, Hex27) {
  compare_with_each_point<TestType, Gauss<1>>();
  compare_with_each_point<TestType, Lobatto<3>>();
  compare_with_each_point<TestType, Gauss<4>>();
  compare_with_each_point<TestType, Corners>();
}

}  // namespace pliant::test::coefficients_test

#include <pliant/formulation/kinematics.hpp>
#include <pliant/quadrature/gauss.hpp>

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
                   Tri3, Tet4, Quad4, Hex8, Tri6, Hex20, Wedge6, General) {
  using E = TestType;
  constexpr auto rule = Gauss<2>::rule<typename E::cell>();
  constexpr auto table = tabulate<E, Gauss<2>, double>();
  Random random;
  auto const v = random_values<E>(random);
  auto const coefficients = Coefficients<E, double>::of(v);
  for (int q = 0; q < rule.count; ++q)
    CHECK(norm(coefficients.gradient(table, q) - plain_gradient<E>(v, rule.points[q])) < 1e-14);
}

TEMPLATE_TEST_CASE("the divergence is the transpose of the gradient", "[formulation]", Tri3, Tet4,
                   Quad4, Hex8, Tri6, Hex20, Wedge6, General) {
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
                   Tet4, Quad4, Hex8, General) {
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

}  // namespace pliant::test::coefficients_test

#include <set>

#include <pliant/element/simplex.hpp>
#include <pliant/element/tensor.hpp>
#include <pliant/quadrature/corners.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

static_assert(Element<Tri3> && Element<Quad4> && Element<Tet4> && Element<Hex8>);
static_assert(LinearSimplex<Tri3> && LinearSimplex<Tet4>);
static_assert(!LinearSimplex<Quad4> && !LinearSimplex<Hex8>);
static_assert(!Element<Triangle> && !Element<int>);

template <class E>
constexpr bool is_simplex =
    std::same_as<typename E::cell, Triangle> || std::same_as<typename E::cell, Tetrahedron>;

/// Where an element's nodes lie on its reference cell, by its documentation.
template <class E>
std::vector<Vector<double, E::dim>> reference_nodes() {
  std::vector<Vector<double, E::dim>> nodes(E::nodes, Vector<double, E::dim>::zero());
  if constexpr (is_simplex<E>) {
    for (int k = 0; k < E::dim; ++k) nodes[static_cast<std::size_t>(k) + 1][k] = 1;
  } else {
    int const corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                               {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int k = 0; k < E::dim; ++k) nodes[a][k] = corners[a][k];
  }
  return nodes;
}
/// Any point of the cell's neighbourhood: shape functions are polynomials everywhere.
template <class E>
Vector<double, E::dim> random_point(Random& random) {
  Vector<double, E::dim> xi;
  for (int k = 0; k < E::dim; ++k) xi[k] = random();
  return xi;
}

TEMPLATE_TEST_CASE("shape functions are one at their node and zero at the others", "[element]",
                   Tri3, Quad4, Tet4, Hex8) {
  auto const nodes = reference_nodes<TestType>();
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    auto const n = TestType::shape(nodes[b]);
    for (int a = 0; a < TestType::nodes; ++a)
      CHECK(n[a] == (static_cast<std::size_t>(a) == b ? 1 : 0));
  }
}

TEMPLATE_TEST_CASE("shape functions add up to one and carry positions", "[element]", Tri3, Quad4,
                   Tet4, Hex8) {
  Random random;
  auto const nodes = reference_nodes<TestType>();
  for (int point = 0; point < 20; ++point) {
    auto const xi = random_point<TestType>(random);
    auto const n = TestType::shape(xi);
    double sum = 0;
    auto position = Vector<double, TestType::dim>::zero();
    for (int a = 0; a < TestType::nodes; ++a) {
      sum += n[a];
      position = position + n[a] * nodes[static_cast<std::size_t>(a)];
    }
    CHECK(sum == Approx(1).epsilon(1e-15));
    CHECK(norm(position - xi) < 1e-15);
  }
}

TEMPLATE_TEST_CASE("gradients are the derivatives of the shape functions", "[element]", Tri3, Quad4,
                   Tet4, Hex8) {
  Random random;
  // Shape functions are linear along each axis: differences are exact, whatever the distance.
  double const h = 0.5;
  for (int point = 0; point < 20; ++point) {
    auto const xi = random_point<TestType>(random);
    auto const gradient = TestType::gradient(xi);
    for (int k = 0; k < TestType::dim; ++k) {
      auto ahead = xi, behind = xi;
      ahead[k] += h;
      behind[k] -= h;
      auto const slope = 1 / (2 * h) * (TestType::shape(ahead) - TestType::shape(behind));
      for (int a = 0; a < TestType::nodes; ++a)
        CHECK(gradient(a, k) == Approx(slope[a]).epsilon(0).margin(1e-15));
    }
  }
}

TEMPLATE_TEST_CASE("sides close the cell and look outward", "[element]", Tri3, Quad4, Tet4, Hex8) {
  auto const nodes = reference_nodes<TestType>();
  auto centre = Vector<double, TestType::dim>::zero();
  for (auto const& x : nodes) centre = centre + 1.0 / TestType::nodes * x;
  std::map<std::pair<int, int>, int> passed;  // how often each edge is run through, by direction
  auto closed = Vector<double, TestType::dim>::zero();
  for (auto const& side : TestType::sides()) {
    std::set<int> const distinct(side.begin(), side.end());
    CHECK(distinct.size() == side.size());
    auto const x = [&](std::size_t a) { return nodes[static_cast<std::size_t>(side[a])]; };
    Vector<double, TestType::dim> normal;
    if constexpr (TestType::dim == 2) {
      auto const along = x(1) - x(0);
      normal = {{{along[1]}, {-along[0]}}};
    } else {
      for (std::size_t a = 0; a < side.size(); ++a)
        ++passed[{side[a], side[(a + 1) % side.size()]}];
      auto const area = [](auto const& a, auto const& b) {
        return Vector<double, 3>{{{(a[1] * b[2] - a[2] * b[1]) / 2},
                                  {(a[2] * b[0] - a[0] * b[2]) / 2},
                                  {(a[0] * b[1] - a[1] * b[0]) / 2}}};
      };
      normal = area(x(1) - x(0), x(2) - x(0));
      if (side.size() == 4) normal = normal + area(x(2) - x(0), x(side.size() - 1) - x(0));
    }
    CHECK(dot(normal, x(0) - centre) > 0);
    closed = closed + normal;
  }
  CHECK(norm(closed) < 1e-15);
  if constexpr (TestType::dim == 3)
    for (auto const& [edge, times] : passed) {
      CHECK(times == 1);
      CHECK(passed.count({edge.second, edge.first}) == 1);
    }
}

TEMPLATE_TEST_CASE("edges are those of the sides, each once", "[element]", Tri3, Quad4, Tet4,
                   Hex8) {
  std::set<std::set<int>> of_sides, listed;
  for (auto const& side : TestType::sides())
    for (std::size_t a = 0; a < side.size(); ++a)
      of_sides.insert({side[a], side[(a + 1) % side.size()]});
  for (auto const& edge : TestType::edges()) listed.insert({edge[0], edge[1]});

  CHECK(listed == of_sides);
  CHECK(listed.size() == TestType::edges().size());
  // Euler: nodes − edges + sides = 2, where in 2D the face itself counts twice.
  int const faces = TestType::dim == 2 ? 2 : static_cast<int>(TestType::sides().size());
  CHECK(TestType::nodes - static_cast<int>(listed.size()) + faces == 2);
}

TEMPLATE_TEST_CASE("the corner rule has its points at the nodes", "[element]", Tri3, Quad4, Tet4,
                   Hex8) {
  static_assert(QuadratureOn<Corners, typename TestType::cell>);
  constexpr auto rule = Corners::rule<typename TestType::cell>();
  auto const nodes = reference_nodes<TestType>();
  REQUIRE(rule.count == TestType::nodes);
  for (int a = 0; a < rule.count; ++a)
    for (int k = 0; k < TestType::dim; ++k)
      CHECK(rule.points[a][k] == nodes[static_cast<std::size_t>(a)][k]);
}

}  // namespace pliant::test

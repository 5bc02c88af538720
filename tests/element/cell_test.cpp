#include <map>
#include <set>

#include <pliant/quadrature/corners.hpp>

#include "support/catch.hpp"
#include "support/elements.hpp"

namespace pliant::test::cell_test {

static_assert(TensorCell<Hexahedron> && !TensorCell<Wedge> && SimplexCell<Triangle>);

#define ALL_CELLS Triangle, Quadrilateral, Tetrahedron, Hexahedron, Wedge, Pyramid

/// The corners of a side, without what fills its row up.
template <std::size_t N>
std::vector<int> corners_of(std::array<int, N> const& side) {
  std::vector<int> corners;
  for (int a : side)
    if (a >= 0) corners.push_back(a);
  return corners;
}

TEMPLATE_TEST_CASE("sides close the cell and look outward", "[element]", ALL_CELLS) {
  auto const centre = middle_of<TestType>();
  std::map<std::pair<int, int>, int> passed;  // how often each edge is run through, by direction
  auto closed = Vector<double, TestType::dim>::zero();
  double volume = 0;
  for (auto const& row : TestType::sides()) {
    auto const side = corners_of(row);
    CHECK(std::set<int>(side.begin(), side.end()).size() == side.size());
    auto const x = [&](std::size_t a) { return TestType::corner(side[a]); };
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
      if (side.size() == 4) normal = normal + area(x(2) - x(0), x(3) - x(0));
    }
    CHECK(dot(normal, x(0) - centre) > 0);
    closed = closed + normal;
    volume += dot(normal, x(0)) / TestType::dim;  // the divergence theorem: sides are plane
  }
  CHECK(norm(closed) < 1e-15);
  CHECK(volume == Approx(TestType::volume).epsilon(1e-15));
  for (auto const& [edge, times] : passed) {
    CHECK(times == 1);
    CHECK(passed.count({edge.second, edge.first}) == 1);
  }
}

TEMPLATE_TEST_CASE("edges are those of the sides, each once", "[element]", ALL_CELLS) {
  std::set<std::set<int>> of_sides, listed;
  for (auto const& row : TestType::sides()) {
    auto const side = corners_of(row);
    for (std::size_t a = 0; a < side.size(); ++a)
      of_sides.insert({side[a], side[(a + 1) % side.size()]});
  }
  for (auto const& edge : TestType::edges()) listed.insert({edge[0], edge[1]});

  CHECK(listed == of_sides);
  CHECK(listed.size() == TestType::edges().size());
  // Euler: corners − edges + sides = 2, where in 2D the face itself counts twice.
  int const faces = TestType::dim == 2 ? 2 : static_cast<int>(TestType::sides().size());
  CHECK(TestType::corners - static_cast<int>(listed.size()) + faces == 2);
}

TEMPLATE_TEST_CASE("the corner rule has its points at the corners", "[element]", Triangle,
                   Quadrilateral, Tetrahedron, Hexahedron, Wedge) {
  static_assert(QuadratureOn<Corners, TestType>);
  constexpr auto rule = Corners::rule<TestType>();
  REQUIRE(rule.count == TestType::corners);
  double sum = 0;
  for (int a = 0; a < rule.count; ++a) {
    sum += rule.weights[a];
    for (int k = 0; k < TestType::dim; ++k) CHECK(rule.points[a][k] == TestType::corner(a)[k]);
  }
  CHECK(sum == Approx(TestType::volume).epsilon(1e-15));
  static_assert(!QuadratureOn<Corners, Pyramid>);
}

}  // namespace pliant::test::cell_test

#include <pliant/formulation/physics.hpp>
#include <pliant/mesh/check.hpp>

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/meshes.hpp"

namespace pliant::test {

template <Element E>
Mesh<E> slab() {
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {3, 2}, .cells = {4, 3}, .origin = {-1, 5}});
  else
    return mesh::box<E>({.size = {3, 2, 1.5}, .cells = {4, 3, 2}, .origin = {-1, 5, 0.5}});
}

TEMPLATE_TEST_CASE("a generated mesh fills its box with sound elements", "[mesh]", Tri3, Quad4,
                   Tet4, Hex8) {
  auto const mesh = slab<TestType>();
  CHECK_NOTHROW(check(mesh));
  int const cells = TestType::dim == 2 ? 12 : 24, nodes = TestType::dim == 2 ? 20 : 60;
  int const split = std::same_as<TestType, Tri3> ? 2 : std::same_as<TestType, Tet4> ? 6 : 1;
  CHECK(mesh.nodes.size() == static_cast<std::size_t>(nodes));
  CHECK(mesh.template elements<TestType>().size() == static_cast<std::size_t>(cells * split));
  double const box = TestType::dim == 2 ? 6 : 9;
  double sum = 0;
  for (auto const& e : mesh.template elements<TestType>()) {
    double const v = volume<TestType, Gauss<2>>(nodal(mesh, e));
    CHECK(v == Approx(box / cells / split).epsilon(1e-13));
    double shares = 0;
    auto const nodal_shares = nodal_volumes<TestType>(nodal(mesh, e));
    for (int a = 0; a < TestType::nodes; ++a) shares += nodal_shares[a];
    CHECK(shares == Approx(v).epsilon(1e-14));
    sum += v;
  }
  CHECK(sum == Approx(box).epsilon(1e-13));
}

/// Σ over facets of area × outward normal, and of area, from the corners of a facet.
template <std::size_t Dim, std::size_t N>
std::array<double, 3> area_vector(FieldOf<Dim> const& nodes, std::array<Index, N> const& facet) {
  auto const x = [&](std::size_t a) {
    std::array<double, 3> p{};
    std::ranges::copy(nodes[static_cast<std::size_t>(facet[a])], p.begin());
    return p;
  };
  if constexpr (Dim == 2) return {x(1)[1] - x(0)[1], x(0)[0] - x(1)[0], 0};
  std::array<double, 3> sum{};
  for (std::size_t last = 2; last < N && facet[last] >= 0; ++last)
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t const i = (k + 1) % 3, j = (k + 2) % 3;
      sum[k] += ((x(last - 1)[i] - x(0)[i]) * (x(last)[j] - x(0)[j]) -
                 (x(last - 1)[j] - x(0)[j]) * (x(last)[i] - x(0)[i])) /
                2;
    }
  return sum;
}

TEMPLATE_TEST_CASE("boundaries lie where their names say and look outward", "[mesh]", Tri3, Quad4,
                   Tet4, Hex8) {
  auto const mesh = slab<TestType>();
  struct Face {
    char const* name;
    std::size_t direction;
    double at, area;
  };
  bool const plane = TestType::dim == 2;
  std::vector<Face> faces =
      plane ? std::vector<Face>{{"left", 0, -1, -2},
                                {"right", 0, 2, 2},
                                {"bottom", 1, 5, -3},
                                {"top", 1, 7, 3}}
            : std::vector<Face>{{"left", 0, -1, -3}, {"right", 0, 2, 3},     {"front", 1, 5, -4.5},
                                {"back", 1, 7, 4.5}, {"bottom", 2, 0.5, -6}, {"top", 2, 2, 6}};
  CHECK(mesh.boundaries.size() == faces.size());
  for (auto const& face : faces) {
    INFO(face.name);
    std::array<double, 3> total{};
    for (auto const& facet : mesh.boundary(face.name)) {
      auto const area = area_vector(mesh.nodes, facet);
      CHECK(area[face.direction] * face.area > 0);
      for (std::size_t k = 0; k < 3; ++k) total[k] += area[k];
    }
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(total[k] == Approx(k == face.direction ? face.area : 0).margin(1e-13));
    for (Index node : nodes_of(mesh.boundary(face.name)))
      CHECK(mesh.nodes[static_cast<std::size_t>(node)][face.direction] ==
            Approx(face.at).epsilon(1e-15));
  }
}

TEMPLATE_TEST_CASE("every boundary facet is a side of one element", "[mesh]", Tri3, Quad4, Tet4,
                   Hex8) {
  auto const mesh = slab<TestType>();
  std::map<std::vector<Index>, int> sides;
  auto const sorted = [](std::vector<Index> nodes) {
    std::erase(nodes, -1);
    std::ranges::sort(nodes);
    return nodes;
  };
  for (auto const& e : mesh.template elements<TestType>())
    for (auto const& side : TestType::sides()) {
      std::vector<Index> nodes;
      for (int a : side) nodes.push_back(e[static_cast<std::size_t>(a)]);
      ++sides[sorted(nodes)];
    }
  std::size_t outside = 0, facets = 0;
  for (auto const& [side, times] : sides) {
    CHECK(times <= 2);
    outside += times == 1;
  }
  for (auto const& [name, list] : mesh.boundaries)
    for (auto const& facet : list) {
      ++facets;
      CHECK(sides[sorted({facet.begin(), facet.end()})] == 1);
    }
  CHECK(facets == outside);
}

TEST_CASE("sizes that make no mesh are refused", "[mesh]") {
  CHECK_THROWS_AS(mesh::rectangle({.size = {1, 0}, .cells = {2, 2}}), Error);
  CHECK_THROWS_AS(mesh::rectangle({.size = {1, NAN}, .cells = {2, 2}}), Error);
  CHECK_THROWS_AS(mesh::rectangle({.size = {1, 1}, .cells = {2, 0}}), Error);
  CHECK_THROWS_AS(mesh::box({.size = {1, 1, -1}, .cells = {2, 2, 2}}), Error);
  CHECK_THROWS_AS(mesh::box({.size = {1, 1, 1}, .cells = {2, -2, 2}}), Error);
}

TEST_CASE("a boundary of another name is refused, with those that there are", "[mesh]") {
  auto const mesh = slab<Quad4>();
  CHECK_THROWS_WITH(mesh.boundary("lid"), says("\"lid\"") && says("bottom, left, right, top"));
}

}  // namespace pliant::test

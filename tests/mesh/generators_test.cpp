#include <set>

#include <pliant/formulation/mass.hpp>
#include <pliant/mesh/check.hpp>

#include "support/catch.hpp"
#include "support/elements.hpp"
#include "support/fields.hpp"
#include "support/meshes.hpp"

namespace pliant::test::generators_test {

template <Element E>
Mesh<E> slab() {
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {3, 2}, .cells = {4, 3}, .origin = {-1, 5}});
  else
    return mesh::box<E>({.size = {3, 2, 1.5}, .cells = {4, 3, 2}, .origin = {-1, 5, 0.5}});
}

TEMPLATE_TEST_CASE("a generated mesh fills its box with sound elements", "[mesh]", ALL_ELEMENTS) {
  auto const mesh = slab<TestType>();
  CHECK_NOTHROW(check(mesh));
  int const cells = TestType::dim == 2 ? 12 : 24;
  int const split = std::same_as<typename TestType::cell, Triangle>      ? 2
                    : std::same_as<typename TestType::cell, Tetrahedron> ? 6
                    : std::same_as<typename TestType::cell, Pyramid>     ? 6
                    : std::same_as<typename TestType::cell, Wedge>       ? 2
                                                                         : 1;
  CHECK(mesh.template elements<TestType>().size() == static_cast<std::size_t>(cells * split));
  // Each node belongs to some element, and no two lie at one place.
  std::set<Index> used;
  std::set<Point<TestType::dim>> places(mesh.nodes.begin(), mesh.nodes.end());
  for (auto const& e : mesh.template elements<TestType>()) used.insert(e.begin(), e.end());
  CHECK(used.size() == mesh.nodes.size());
  CHECK(places.size() == mesh.nodes.size());
  double const box = TestType::dim == 2 ? 6 : 9;
  double sum = 0;
  for (auto const& e : mesh.template elements<TestType>()) {
    double const v = volume<TestType, Gauss<2>>(nodal(mesh, e));
    CHECK(v == Approx(box / cells / split).epsilon(1e-13));
    sum += v;
  }
  CHECK(sum == Approx(box).epsilon(1e-13));
}

/// Σ over facets of area × outward normal, from the corners of a facet.
template <int Dim>
std::array<double, 3> area_vector(std::vector<Point<Dim>> const& nodes, Facet<Dim> const& facet) {
  auto const x = [&](std::size_t a) {
    std::array<double, 3> p{};
    std::ranges::copy(nodes[static_cast<std::size_t>(facet[a])], p.begin());
    return p;
  };
  if constexpr (Dim == 2) return {x(1)[1] - x(0)[1], x(0)[0] - x(1)[0], 0};
  std::array<double, 3> sum{};
  for (std::size_t last = 2; last < facet.corners(); ++last)
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t const i = (k + 1) % 3, j = (k + 2) % 3;
      sum[k] += ((x(last - 1)[i] - x(0)[i]) * (x(last)[j] - x(0)[j]) -
                 (x(last - 1)[j] - x(0)[j]) * (x(last)[i] - x(0)[i])) /
                2;
    }
  return sum;
}

TEMPLATE_TEST_CASE("boundaries lie where their names say and look outward", "[mesh]",
                   ALL_ELEMENTS) {
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
      auto const area = area_vector<TestType::dim>(mesh.nodes, facet);
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
  auto const key = [](auto const& facet) {
    std::vector<Index> nodes(facet.begin(), facet.end());
    std::ranges::sort(nodes);
    return nodes;
  };
  std::map<std::vector<Index>, int> sides;
  constexpr int count = static_cast<int>(TestType::cell::sides().size());
  for (auto const& e : mesh.template elements<TestType>())
    for (int s = 0; s < count; ++s) ++sides[key(mesh::side_of<TestType>(e, s))];
  std::size_t outside = 0, facets = 0;
  for (auto const& [side, times] : sides) {
    CHECK(times <= 2);
    outside += times == 1;
  }
  for (auto const& [name, list] : mesh.boundaries)
    for (auto const& facet : list) {
      ++facets;
      CHECK(sides[key(facet)] == 1);
    }
  CHECK(facets == outside);
  CHECK(mesh::outer_sides(mesh).size() == outside);
}

TEST_CASE("a facet has the nodes of its side: corners, then those between them", "[mesh]") {
  CHECK(mesh::nodes_on_side<Tri6>(1) == Facet<2>{1, 2, 4});
  CHECK(mesh::nodes_on_side<Quad9>(3) == Facet<2>{3, 0, 7});
  CHECK(mesh::nodes_on_side<Tet4>(2) == Facet<3>{1, 2, 3});
  CHECK(mesh::nodes_on_side<Tet10>(0) == Facet<3>{0, 2, 1, 6, 5, 4});
  CHECK(mesh::nodes_on_side<Hex20>(5) == Facet<3>{4, 5, 6, 7, 12, 13, 14, 15});
  CHECK(mesh::nodes_on_side<Hex27>(5) == Facet<3>{4, 5, 6, 7, 12, 13, 14, 15, 25});
  CHECK(mesh::nodes_on_side<Wedge6>(0) == Facet<3>{0, 2, 1});
  CHECK(mesh::nodes_on_side<Pyramid5>(0) == Facet<3>{0, 3, 2, 1});
  CHECK(mesh::nodes_on_side<Wedge6>(0).corners() == 3);
  CHECK(mesh::nodes_on_side<Tet10>(0).corners() == 3);
  CHECK(mesh::nodes_on_side<Hex20>(0).corners() == 4);
  CHECK(mesh::nodes_on_side<Hex27>(0).corners() == 4);
  CHECK(mesh::nodes_on_side<Quad8>(0).corners() == 2);
}

TEST_CASE("outer sides are found by their place", "[mesh]") {
  auto const mesh = slab<Hex20>();
  auto const lid = mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[2] > 1.99; });
  CHECK(nodes_of(lid) == nodes_of(mesh.boundary("top")));
}

TEST_CASE("nodes of facets are told each once, also those that no mesh has", "[mesh]") {
  std::vector<Facet<3>> const facets{{4, -7, 2}, {2, 9, 4}};
  CHECK(nodes_of(facets) == std::vector<Index>{-7, 2, 4, 9});
}

TEST_CASE("elements of nodes that the mesh has not are refused when its sides are looked for",
          "[mesh]") {
  for (Index wrong : {-1, 20}) {
    auto mesh = slab<Quad4>();
    mesh.elements<Quad4>()[5][2] = wrong;
    CHECK_THROWS_WITH(mesh::outer_sides(mesh),
                      says("node " + std::to_string(wrong)) && says("20 nodes"));
  }
}

TEST_CASE("boundaries that are no sides are refused where elements are raised", "[mesh]") {
  auto mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  std::swap(mesh.elements<Quad4>()[0][0], mesh.elements<Quad4>()[0][1]);
  CHECK_THROWS_WITH(mesh::raised<Quad9>(mesh), says("mesh::raised: a facet of the boundary"));
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

}  // namespace pliant::test::generators_test

#include <pliant/element/quadratic_tensor.hpp>
#include <pliant/mesh/box.hpp>
#include <pliant/mesh/check.hpp>
#include <pliant/mesh/rectangle.hpp>

#include "support/catch.hpp"
#include "support/meshes.hpp"

namespace pliant::test::check_test {

template <Element E>
Mesh<E> small_mesh() {
  return distorted_mesh<E>(3);
}

TEMPLATE_TEST_CASE("an element that is there twice is refused", "[mesh][errors]", Tri3, Quad4, Tet4,
                   Hex8) {
  auto mesh = small_mesh<TestType>();
  CHECK_NOTHROW(check(mesh));
  auto& elements = mesh.template elements<TestType>();
  elements.push_back(elements[2]);
  auto const says_so =
      says(std::string(TestType::name()) + " element " + std::to_string(elements.size() - 1));
  CHECK_THROWS_WITH(check(mesh), says_so && says("is element 2 again"));
  if constexpr (std::same_as<TestType, Quad4>) {  // numbered from another corner
    auto& last = elements.back();
    std::rotate(last.begin(), last.begin() + 1, last.end());
    CHECK_THROWS_WITH(check(mesh), says_so);
  }
}

TEST_CASE("a node of no element is refused", "[mesh][errors]") {
  auto mesh = small_mesh<Tri3>();
  mesh.nodes.push_back({7, 8});
  CHECK_THROWS_WITH(check(mesh), says("node " + std::to_string(mesh.nodes.size() - 1)) &&
                                     says("(7, 8) belongs to no element"));
}

/// A coarse cell beside cells of half its size: nodes 0, 1 at its free side, 2 and 3 where 4 hangs.
inline Mesh<Quad4> two_levels() {
  Mesh<Quad4> mesh;
  mesh.nodes = {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {1, 0.5}, {1.5, 0}, {1.5, 0.5}, {1.5, 1}};
  mesh.elements<Quad4>() = {{0, 2, 3, 1}, {2, 5, 6, 4}, {4, 6, 7, 3}};
  return mesh;
}

TEST_CASE("a node that hangs between quadrilaterals is listed or refused", "[mesh][errors]") {
  auto mesh = shuffled(two_levels(), 3);
  auto const at = [&](Point<2> const& x) {
    return static_cast<Index>(std::ranges::find(mesh.nodes, x) - mesh.nodes.begin());
  };
  Index const hanging = at({1, 0.5}), low = at({1, 0}), high = at({1, 1});
  CHECK_THROWS_WITH(check(mesh),
                    says("node " + std::to_string(hanging) + " at (1, 0.5) hangs on the edge") &&
                        says("mesh.slaves"));
  mesh.slaves = {{hanging, {{low, 0.5}, {high, 0.5}}}};
  CHECK_NOTHROW(check(mesh));
}

TEST_CASE("a slit between quadratic elements is no hanging node", "[mesh]") {
  auto mesh = mesh::rectangle<Quad8>({.size = {1, 2}, .cells = {1, 2}});
  auto& upper = mesh.elements<Quad8>()[1];
  int parted = 0;
  for (Index& node : upper) {  // all between the elements but the tip
    auto const place = mesh.nodes[static_cast<std::size_t>(node)];
    if (place[1] != 1 || place[0] == 0) continue;
    node = static_cast<Index>(mesh.nodes.size());
    mesh.nodes.push_back(place);
    ++parted;
  }
  REQUIRE(parted == 2);
  CHECK_NOTHROW(check(mesh));
  mesh.nodes.back()[0] -= 0.1;  // no longer where the other lip has one
  CHECK_THROWS_AS(check(mesh), Error);
}

TEST_CASE("a node that hangs between triangles is refused", "[mesh][errors]") {
  Mesh<Tri3> mesh;
  mesh.nodes = {{0, 0}, {1, 0.25}, {0.25, 1}, {0.625, 0.625}, {1.25, 1.5}};
  mesh.elements<Tri3>() = {{0, 1, 2}, {1, 4, 3}, {3, 4, 2}};
  CHECK_THROWS_WITH(check(mesh), says("node 3 at (0.625, 0.625) hangs on the edge"));
  mesh.slaves = {{3, {{1, 0.5}, {2, 0.5}}}};
  CHECK_NOTHROW(check(mesh));
}

TEST_CASE("a node a quarter along an edge hangs too", "[mesh][errors]") {
  auto mesh = two_levels();
  mesh.slaves = {{4, {{2, 0.5}, {3, 0.5}}}};
  mesh.nodes.push_back({1, 0.25});
  mesh.nodes.push_back({1.25, 0});
  mesh.nodes.push_back({1.25, 0.25});
  mesh.nodes.push_back({1.5, 0.25});
  mesh.nodes.push_back({1.25, 0.5});
  mesh.elements<Quad4>()[1] = {2, 9, 10, 8};
  mesh.elements<Quad4>().push_back({9, 5, 11, 10});
  mesh.elements<Quad4>().push_back({10, 11, 6, 12});
  mesh.elements<Quad4>().push_back({8, 10, 12, 4});
  CHECK_THROWS_WITH(check(mesh), says("node 8 at (1, 0.25)"));
  mesh.slaves.push_back({8, {{2, 0.5}, {4, 0.5}}});
  CHECK_THROWS_WITH(check(mesh), says("node 12 at (1.25, 0.5)"));
  mesh.slaves.push_back({12, {{4, 0.5}, {6, 0.5}}});
  CHECK_NOTHROW(check(mesh));
}

/// One cube of edge 2 beside four of edge 1.
inline Mesh<Hex8> cubes() {
  Mesh<Hex8> mesh;
  auto const node = [&](double x, double y, double z) {
    Point<3> const p{x, y, z};
    auto const found = std::ranges::find(mesh.nodes, p);
    if (found != mesh.nodes.end()) return static_cast<Index>(found - mesh.nodes.begin());
    mesh.nodes.push_back(p);
    return static_cast<Index>(mesh.nodes.size() - 1);
  };
  auto const cube = [&](double x, double y, double z, double a) {
    mesh.elements<Hex8>().push_back({node(x, y, z), node(x + a, y, z), node(x + a, y + a, z),
                                     node(x, y + a, z), node(x, y, z + a), node(x + a, y, z + a),
                                     node(x + a, y + a, z + a), node(x, y + a, z + a)});
  };
  cube(0, 0, 0, 2);
  for (double y : {0.0, 1.0})
    for (double z : {0.0, 1.0}) cube(2, y, z, 1);
  return mesh;
}

TEST_CASE("nodes that hang on a cube are refused until all are listed", "[mesh][errors]") {
  auto mesh = cubes();
  auto const at = [&](double y, double z) {
    return static_cast<Index>(std::ranges::find(mesh.nodes, Point<3>{2, y, z}) -
                              mesh.nodes.begin());
  };
  auto const between = [&](Index node, std::vector<Index> const& masters) {
    Slave slave{node, {}};
    for (Index m : masters)
      slave.masters.emplace_back(m, 1.0 / static_cast<double>(masters.size()));
    return slave;
  };
  CHECK_THROWS_WITH(check(mesh), says("hangs on the edge"));
  mesh.slaves = {between(at(1, 0), {at(0, 0), at(2, 0)}), between(at(0, 1), {at(0, 0), at(0, 2)}),
                 between(at(2, 1), {at(2, 0), at(2, 2)}), between(at(1, 2), {at(0, 2), at(2, 2)})};
  CHECK_THROWS_WITH(check(mesh),
                    says("node " + std::to_string(at(1, 1)) + " at (2, 1, 1) hangs on the side"));
  mesh.slaves.push_back(between(at(1, 1), {at(0, 0), at(2, 0), at(0, 2), at(2, 2)}));
  CHECK_NOTHROW(check(mesh));
}

TEST_CASE("meshes that fit together have no node that hangs", "[mesh]") {
  CHECK_NOTHROW(check(regular_mesh<Tri3>(4)));
  CHECK_NOTHROW(check(regular_mesh<Quad8>(3)));
  CHECK_NOTHROW(check(regular_mesh<Tet4>(3)));
  CHECK_NOTHROW(check(regular_mesh<Hex8>(3)));
  CHECK_NOTHROW(check(regular_mesh<Wedge6>(3)));
  CHECK_NOTHROW(check(regular_mesh<Pyramid5>(3)));
  CHECK_NOTHROW(check(regular_mesh<Hex27>(2)));
  CHECK_NOTHROW(check(mixed_mesh(4)));
}

TEST_CASE("a slit whose faces have nodes of their own is no hanging node", "[mesh]") {
  auto mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  mesh.nodes.push_back(mesh.nodes[3]);  // the left half of the middle line is open
  for (Index e : {2}) mesh.elements<Quad4>()[static_cast<std::size_t>(e)][0] = 9;
  CHECK_NOTHROW(check(mesh));
}

TEST_CASE("slaves need masters whose weights add up to one", "[mesh][errors]") {
  auto const refused = [](Slave const& slave) {
    auto mesh = two_levels();
    mesh.slaves = {slave};
    CHECK_THROWS_WITH(check(mesh), says("mesh: slave " + std::to_string(slave.node)));
  };
  refused({4, {{2, 0.5}, {3, 0.4}}});
  refused({4, {{2, 1.5}, {3, -0.5}}});
  refused({4, {{2, 0.5}, {3, NAN}}});
  refused({4, {{2, 0.25}, {3, 0.75}}});  // elsewhere on the edge
  refused({4, {}});
  refused({4, {{4, 0.5}, {3, 0.5}}});
  refused({4, {{2, 0.5}, {8, 0.5}}});
  refused({8, {{2, 0.5}, {3, 0.5}}});
  refused({-1, {{2, 0.5}, {3, 0.5}}});
}

TEST_CASE("generators refuse sizes that are not positive and finite", "[mesh][errors]") {
  for (double size : {double{INFINITY}, double{NAN}, 0.0, -1.0}) {
    CHECK_THROWS_WITH(mesh::rectangle({.size = {1, size}, .cells = {1, 1}}),
                      says("mesh::rectangle") && says("finite size"));
    CHECK_THROWS_WITH(mesh::box({.size = {1, 1, size}, .cells = {1, 1, 1}}),
                      says("mesh::box") && says("finite size"));
  }
  CHECK_THROWS_AS(mesh::rectangle({.size = {1, 1}, .cells = {1, 1}, .origin = {0, INFINITY}}),
                  Error);
  CHECK_THROWS_AS(mesh::box({.size = {1, 1, 1}, .cells = {1, 1, 1}, .origin = {NAN, 0, 0}}), Error);
  CHECK_THROWS_AS(mesh::rectangle({.size = {1, 1}, .cells = {0, 1}}), Error);
  CHECK_THROWS_AS(mesh::box({.size = {1, 1, 1}, .cells = {1, -1, 1}}), Error);
}

TEST_CASE("sides that two elements share are no outer sides", "[mesh]") {
  auto const count = [](auto const& mesh) { return mesh::outer_sides(mesh).size(); };
  CHECK(count(mesh::rectangle({.size = {1, 1}, .cells = {5, 3}})) == 16);
  CHECK(count(shuffled(mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {5, 3}}))) == 16);
  CHECK(count(shuffled(mesh::box({.size = {1, 1, 1}, .cells = {2, 3, 4}}))) == 52);
  CHECK(count(shuffled(mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {2, 3, 4}}))) == 104);
  CHECK(count(two_levels()) == 10);
  auto thrice = mesh::rectangle({.size = {1, 1}, .cells = {1, 1}});
  auto& elements = thrice.elements<Quad4>();
  elements = {elements[0], elements[0], elements[0]};
  CHECK(count(thrice) == 0);
}

}  // namespace pliant::test::check_test

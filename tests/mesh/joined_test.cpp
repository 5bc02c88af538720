#include <pliant/mesh/joined.hpp>

#include "support/formulations.hpp"
#include "support/meshes.hpp"

namespace pliant::test::joined_test {

using Mixed = Mesh<Tet4, Hex8>;

Mixed mixed(Point<3> const& at) {
  auto const tets = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {1, 2, 1}});
  auto const hexes =
      mesh::moved(mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {2, 1, 1}}), {3, 0, 0});
  auto one = mesh::joined<Tet4, Hex8>(
      {mesh::with_types<Tet4, Hex8>(tets), mesh::with_types<Tet4, Hex8>(hexes)});
  return mesh::moved(one.mesh, at);
}

TEST_CASE("joined meshes keep the elements, boundaries and slaves of each", "[mesh]") {
  std::vector<Mixed> parts{mixed({0, 0, 0}), mixed({0, 2, 0}), mixed({0, 4, 0})};
  parts[1].slaves = {{2, {{0, 0.5}, {1, 0.5}}}};
  auto const all = mesh::joined(parts);
  REQUIRE(all.parts() == 3);
  auto const nodes = static_cast<Index>(parts[0].nodes.size());
  CHECK(all.first_node == std::vector<Index>{0, nodes, 2 * nodes, 3 * nodes});
  for (std::size_t p = 0; p < 3; ++p) {
    auto const first = static_cast<std::size_t>(all.first_node[p]);
    for (std::size_t i = 0; i < parts[p].nodes.size(); ++i)
      CHECK(all.mesh.nodes[first + i] == parts[p].nodes[i]);
    auto const same = [&]<Element E>(E, std::size_t type) {
      auto const& own = parts[p].elements<E>();
      auto const begin = static_cast<std::size_t>(all.first_element[type][p]);
      REQUIRE(all.first_element[type][p + 1] - all.first_element[type][p] ==
              static_cast<Index>(own.size()));
      for (std::size_t e = 0; e < own.size(); ++e)
        for (std::size_t a = 0; a < E::nodes; ++a)
          CHECK(all.mesh.elements<E>()[begin + e][a] == own[e][a] + all.first_node[p]);
    };
    same(Tet4{}, 0);
    same(Hex8{}, 1);
    auto const& own = parts[p].boundary("left");
    auto const found = all.boundary(p, "left");
    REQUIRE(found.size() == own.size());
    REQUIRE(!own.empty());
    for (std::size_t f = 0; f < own.size(); ++f) {
      REQUIRE(found[f].size() == own[f].size());
      for (std::size_t a = 0; a < own[f].size(); ++a)
        CHECK(found[f][a] == own[f][a] + all.first_node[p]);
    }
  }
  CHECK(all.mesh.boundary("left").size() == 3 * parts[0].boundary("left").size());
  REQUIRE(all.mesh.slaves.size() == 1);
  CHECK(all.mesh.slaves[0].node == nodes + 2);
  CHECK(all.mesh.slaves[0].masters[1].first == nodes + 1);
}

TEST_CASE("joined meshes say what they have not", "[mesh]") {
  auto const square = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {1, 1}});
  auto const all = mesh::joined<Quad4>({square, mesh::moved(square, {2, 0})});
  CHECK_THROWS_WITH(all.boundary(2, "left"), says("there is no part 2"));
  CHECK_THROWS_WITH(all.boundary(1, "lid"), says("no boundary is called \"lid\""));
  CHECK(mesh::joined(std::vector<Mesh<Quad4>>{}).parts() == 0);
}

}  // namespace pliant::test::joined_test

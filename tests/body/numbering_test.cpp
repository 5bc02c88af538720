#include <set>

#include <pliant/body/numbering.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/mesh/box.hpp>

#include "support/catch.hpp"

namespace pliant::test::numbering_test {

template <Element E>
Mesh<E> box_of(int cells) {
  return mesh::box<E>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
}

TEST_CASE("a numbering permutes nodes and elements, and keeps each element's nodes", "[body]") {
  auto mesh = box_of<Tet4>(5);
  mesh.nodes.push_back({0.3, 0.3, 0.3});  // of no element
  Numbering<Tet4> const numbering(mesh);
  auto const nodes = static_cast<Index>(mesh.nodes.size());

  REQUIRE(numbering.user_node.size() == mesh.nodes.size());
  for (Index i = 0; i < nodes; ++i)
    CHECK(numbering.internal_node[static_cast<std::size_t>(
              numbering.user_node[static_cast<std::size_t>(i)])] == i);
  CHECK(numbering.user_node.back() == nodes - 1);

  auto const& user = mesh.elements<Tet4>();
  auto const& order = numbering.user_element[0];
  auto const& table = std::get<0>(numbering.tables);
  CHECK(std::set(order.begin(), order.end()).size() == user.size());
  REQUIRE(table.size() == user.size());
  for (std::size_t e = 0; e < table.size(); ++e)
    for (std::size_t a = 0; a < 4; ++a)
      CHECK(numbering.user_node[static_cast<std::size_t>(table[e][a])] ==
            user[static_cast<std::size_t>(order[e])][a]);
}

/// The mean number of nodes of the whole runs of `size` elements.
template <Element E>
double nodes_of_run(Mesh<E> const& mesh, std::size_t size) {
  Numbering<E> const numbering(mesh);
  auto const& table = std::get<0>(numbering.tables);
  std::size_t nodes = 0;
  for (std::size_t first = 0; first + size <= table.size(); first += size) {
    std::set<Index> found;
    for (std::size_t e = first; e < first + size; ++e)
      found.insert(table[e].begin(), table[e].end());
    nodes += found.size();
  }
  return static_cast<double>(nodes) / static_cast<double>(table.size() / size);
}

// What a run of elements costs on a GPU follows its nodes. A cube of 125 cells has 216, one of 128 about 219.
TEST_CASE("a run of elements has few nodes, whether or not cells fit the curve", "[body]") {
  for (int cells : {20, 23, 27}) {
    INFO(cells << " cells along an edge");
    CHECK(nodes_of_run(box_of<Tet4>(cells), 768) < 250);
    CHECK(nodes_of_run(box_of<Hex8>(cells), 128) < 250);
  }
}

// A GPU goes around the longest edge of a cell's tetrahedra.
TEST_CASE("the tetrahedra of a cell lie behind each other", "[body]") {
  auto mesh = box_of<Tet4>(7);
  for (auto& x : mesh.nodes) x[0] += 0.02 * x[1] - 0.03 * x[2] * x[0];
  Numbering<Tet4> const numbering(mesh);
  auto const& order = numbering.user_element[0];
  std::size_t whole = 0;
  for (std::size_t e = 0; e < order.size(); e += 6)
    whole += std::all_of(order.begin() + static_cast<std::ptrdiff_t>(e),
                         order.begin() + static_cast<std::ptrdiff_t>(e) + 6,
                         [&](Index user) { return user / 6 == order[e] / 6; });
  CHECK(whole == order.size() / 6);
}

}  // namespace pliant::test::numbering_test

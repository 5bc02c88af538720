#pragma once

#include <set>

#include "body/refined_mesh.hpp"
#include "support/formulations.hpp"

// The order of elements, and the rows of nodes, of a mesh that is refined in a backend's memory.
namespace pliant::test::rows_on_suite {

/// The same as a look at the whole tree gives it.
template <class B, Element... Es>
void check_order(RefinedMesh<B, Es...> const& mesh) {
  std::vector<Index> wanted, first{0};
  for (Index block = 0; block < mesh.first.blocks(); ++block) {
    detail::for_each_leaf(*mesh.host, mesh.first, block, [&](Index c) { wanted.push_back(c); });
    first.push_back(static_cast<Index>(wanted.size()));
  }
  auto const leaves = mesh.leaves();
  REQUIRE(leaves == wanted);
  CHECK(taken(mesh.backend, mesh.order.first_of_block(), mesh.order.blocks() + 1) == first);
  auto const places =
      taken(mesh.backend, mesh.order.places(), static_cast<Index>(mesh.host->cells().size()));
  auto const from = taken(mesh.backend, mesh.order.from(), mesh.order.count());
  int wrong = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    Index const c = leaves[i], before = mesh.leaves_before[at(from[i])];
    wrong += places[at(c)] != static_cast<Index>(i);
    wrong += before != c && before != mesh.host->cell(c).parent;
  }
  CHECK(wrong == 0);
}

/// Nodes keep their rows; others have rows of pages that belong to the region where they are.
template <class B, Element... Es>
void check_rows(RefinedMesh<B, Es...> const& mesh) {
  auto const rows = mesh.rows.download_all();
  auto const& before = mesh.rows_before;
  REQUIRE(rows.of_node.size() == mesh.host->points().size());
  int wrong = 0;
  std::size_t taken_rows = 0;
  for (std::size_t node = 0; node < rows.of_node.size(); ++node) {
    Index const row = rows.of_node[node];
    REQUIRE(row >= 0);
    REQUIRE(row < rows.count());
    wrong += rows.node[at(row)] != static_cast<Index>(node);
    if (node < before.of_node.size()) wrong += row != before.of_node[node];
  }
  for (Index const node : rows.node) taken_rows += node >= 0 ? 1 : 0;
  CHECK(wrong == 0);
  CHECK(taken_rows == rows.of_node.size());
  // By the node, the regions of the leaves that have it.
  std::vector<std::set<Index>> regions(rows.of_node.size());
  for (Index block = 0; block < mesh.first.blocks(); ++block)
    detail::for_each_leaf(*mesh.host, mesh.first, block, [&](Index c) {
      for (Index const node : mesh.host->tree().nodes_of(c)) regions[at(node)].insert(block / 16);
    });
  for (std::size_t node = before.of_node.size(); node < rows.of_node.size(); ++node)
    wrong += !regions[node].contains(rows.region[at(rows.of_node[node] / NodeRows::page)]);
  CHECK(wrong == 0);
  // No more pages than regions with some free rows each explain.
  auto const first_pages = std::ranges::count(rows.region, -2);
  auto const new_nodes = rows.of_node.size() - mesh.numbering.user_node.size();
  CHECK(static_cast<std::size_t>(std::ssize(rows.region) - first_pages) <=
        new_nodes / NodeRows::page + at(mesh.first.blocks() / 16 + 1));
}

template <class B, Element... Es>
void check_rounds(B const& backend, Mesh<Es...> const& given, std::size_t one_in, int rounds) {
  RefinedMesh<B, Es...> mesh(backend, given);
  Random random(5);
  for (int round = 0; round < rounds; ++round) {
    auto marked = mesh.host->leaves();
    std::erase_if(marked, [&](Index) { return random.below(one_in) != 0; });
    mesh.refine(marked);
    REQUIRE(mesh.refined.leaves > 0);
    check_order(mesh);
    check_rows(mesh);
  }
  CHECK(mesh.tree.leaves() > 2 * mesh.first.count());
}

TEST_CASE("children stand in the place of their parents, and their nodes have rows near others",
          "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_rounds(backend, regular_mesh<Tri3>(60), 20, 6);  // two regions
    check_rounds(backend, regular_mesh<Hex8>(17), 20, 3);
    check_rounds(backend, regular_mesh<Tet4>(10), 30, 4);
    check_rounds(backend, mixed_mesh(20), 8, 3);
    check_rounds(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(3)), 6, 3);
  });
}

TEST_CASE("rows of a few new nodes fill the page that their region has", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    RefinedMesh<B, Tri3> mesh(backend, regular_mesh<Tri3>(60));
    mesh.refine({0});
    auto const rows = mesh.rows.count();
    CHECK(rows > static_cast<Index>(mesh.numbering.user_node.size()));
    for (Index k = 1; k < 5; ++k) mesh.refine({mesh.leaves()[0]});
    check_order(mesh);
    check_rows(mesh);
    CHECK(mesh.rows.count() == rows);  // some 27 nodes in all
  });
}

}  // namespace pliant::test::rows_on_suite

#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "body/refined_mesh.hpp"
#include "support/formulations.hpp"

// The order of elements, and the rows of nodes, of a mesh that is refined and coarsened in a backend's memory.
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
  CHECK(mesh.order.told_first_of_block() == first);
  auto const places =
      taken(mesh.backend, mesh.order.places(), static_cast<Index>(mesh.host->cells().size()));
  auto const from = taken(mesh.backend, mesh.order.from(), mesh.order.count());
  auto before = mesh.leaves_before;
  for (Index& c : before) c = mesh.renumbered.cells[c];
  CHECK(taken(mesh.backend, mesh.order.before(), mesh.order.count_before()) == before);
  int wrong = 0, merged = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    Index const c = leaves[i], own = before[at(from[i])];
    wrong += places[at(c)] != static_cast<Index>(i);
    wrong += own >= 0 && own != c && own != mesh.host->cell(c).parent;
    merged += own < 0;
  }
  CHECK(wrong == 0);
  CHECK(merged == std::ssize(mesh.families));
  REQUIRE(mesh.order.merged_count() == merged);
  auto const families = taken(mesh.backend, mesh.order.merged_families(), merged);
  for (std::size_t r = 0; r < families.size(); ++r) {
    auto const &own = families[r], &host = mesh.families[r];
    wrong += own.cell != host.cell || own.place != host.place ||
             own.first_before != host.first_before || own.children != host.children ||
             from[at(own.place)] != own.first_before;
  }
  CHECK(wrong == 0);
}

/// How many rows of each region's pages are free, and how many pages it has.
inline std::map<Index, std::pair<Index, Index>> free_by_region(NodeRows const& rows) {
  std::map<Index, std::pair<Index, Index>> by_region;
  for (std::size_t row = 0; row < rows.node.size(); ++row) {
    auto& [free, pages] = by_region[rows.region[row / NodeRows::page]];
    free += rows.node[row] < 0;
    pages += row % NodeRows::page == 0;
  }
  return by_region;
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
  }
  for (Index const node : rows.node) taken_rows += node >= 0 ? 1 : 0;
  CHECK(taken_rows == rows.of_node.size());
  std::vector<Index> freed;
  std::size_t first_new = 0;
  for (std::size_t old = 0; old < before.of_node.size(); ++old) {
    Index const now = mesh.renumbered.nodes[static_cast<Index>(old)], row = before.of_node[old];
    if (now < 0) {
      freed.push_back(row);
      wrong += rows.node[at(row)] >= 0;
    } else {
      wrong += rows.of_node[at(now)] != row;
      first_new = at(now) + 1;
    }
  }
  CHECK(wrong == 0);
  CHECK(taken(mesh.backend, mesh.rows.freed(), mesh.rows.freed_count()) == freed);
  // By the node, the regions of the leaves that have it.
  std::vector<std::set<Index>> regions(rows.of_node.size());
  for (Index block = 0; block < mesh.first.blocks(); ++block)
    detail::for_each_leaf(*mesh.host, mesh.first, block, [&](Index c) {
      for (Index const node : mesh.host->tree().nodes_of(c)) regions[at(node)].insert(block / 16);
    });
  for (std::size_t node = first_new; node < rows.of_node.size(); ++node)
    wrong += !regions[node].contains(rows.region[at(rows.of_node[node] / NodeRows::page)]);
  CHECK(wrong == 0);
  // Regions take pages when theirs are full, and no further ones while some are free.
  auto const then = free_by_region(before), now = free_by_region(rows);
  for (auto const& [region, own] : now) {
    auto const known = then.find(region);
    Index const pages = known == then.end() ? 0 : known->second.second;
    if (region >= 0 && own.second > pages) wrong += own.first >= NodeRows::page;
  }
  if (rows.region.size() > before.region.size()) wrong += now.contains(-1);
  CHECK(wrong == 0);
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

/// Refines and coarsens at random, then merges all: what the first mesh had is there again.
template <class B, Element... Es>
void check_changes(B const& backend, Mesh<Es...> const& given, std::size_t one_in, int rounds) {
  RefinedMesh<B, Es...> mesh(backend, given);
  mesh.backend.synchronize();
  auto const first_blocks = mesh.order.told_first_of_block();
  Random random(7);
  Index merged = 0, freed = 0;
  for (int round = 0; round < rounds; ++round) {
    auto marked = mesh.host->leaves();
    if (round % 3 != 2) {
      std::erase_if(marked, [&](Index) { return random.below(one_in) != 0; });
      mesh.refine(marked);
    } else {
      // A third of the families.
      auto const part = static_cast<Index>(random.below(3));
      std::erase_if(marked, [&](Index c) { return mesh.host->cell(c).parent % 3 != part; });
      merged += mesh.coarsen(marked);
      freed += mesh.rows.freed_count();
    }
    check_order(mesh);
    check_rows(mesh);
  }
  CHECK(merged > 10);
  CHECK(freed > 10);
  while (mesh.coarsen(mesh.host->leaves()) > 0) {
    check_order(mesh);
    check_rows(mesh);
  }
  check_order(mesh);  // nothing was merged
  check_rows(mesh);
  CHECK(mesh.leaves() == mesh.first.cells);
  mesh.backend.synchronize();
  CHECK(mesh.order.told_first_of_block() == first_blocks);
  auto const rows = mesh.rows.download_all();
  CHECK(rows.of_node == mesh.numbering.internal_node);
  auto const first_rows = std::ssize(mesh.numbering.user_node);
  CHECK(std::vector(rows.node.begin(), rows.node.begin() + first_rows) == mesh.numbering.user_node);
  CHECK(std::all_of(rows.node.begin() + first_rows, rows.node.end(),
                    [](Index node) { return node < 0; }));
  // The pages that are there are taken before there are more.
  mesh.refine({0});
  check_order(mesh);
  check_rows(mesh);
  CHECK(mesh.rows.count() == rows.count());
}

TEST_CASE("merged parents stand in the place of their children, whose rows are free", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_changes(backend, regular_mesh<Tri3>(60), 20, 9);  // two regions
    check_changes(backend, regular_mesh<Quad4>(40), 15, 9);
    check_changes(backend, regular_mesh<Tet4>(8), 30, 6);
    check_changes(backend, regular_mesh<Hex8>(12), 30, 6);
    check_changes(backend, mixed_mesh(20), 8, 6);
    check_changes(backend, regular_mesh<Pyramid5>(3), 10, 6);
    check_changes(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(3)), 6, 6);
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

#pragma once

#include <algorithm>

#include "body/refined_tables.hpp"
#include "support/formulations.hpp"

namespace pliant::test::elements_on_suite {

template <Element E, class B>
void check_rounds(B const& backend, Mesh<E> const& mesh, std::size_t one_in, int rounds) {
  Tables<B, E> tables(backend, mesh);
  Random random(5);
  bool some_stay = false, all_stay = true;
  for (int round = 0; round < rounds; ++round) {
    // In one half of the blocks alone, so that some stay.
    auto const leaves = tables.mesh.leaves();
    std::vector<Index> marked;
    for (std::size_t i = 0; i < leaves.size() / 2; ++i)
      if (random.below(one_in) == 0) marked.push_back(leaves[i]);
    tables.refine(marked);
    REQUIRE(tables.mesh.refined.leaves > 0);
    for (char const stays : tables.blocks.stays) {
      some_stay = some_stay || stays != 0;
      all_stay = all_stay && stays != 0;
    }
  }
  CHECK(some_stay);
  CHECK_FALSE(all_stay);
}

/// Refines and coarsens one half of the blocks at random, then merges all: what the first mesh had is there again.
template <Element E, class B>
void check_changes(B const& backend, Mesh<E> const& mesh, std::size_t one_in, int rounds) {
  Tables<B, E> tables(backend, mesh);
  auto const rows_of = [&] {
    return taken(backend, tables.on.rows_of_nodes().nodes, tables.on.count() * tables.width);
  };
  auto const first_rows = rows_of();
  auto const first_blocks = tables.blocks.first;
  Random random(5);
  Index merged = 0;
  bool some_stay = false, all_stay = true;
  for (int round = 0; round < rounds; ++round) {
    auto const leaves = tables.mesh.leaves();
    std::vector<Index> marked(leaves.begin(), leaves.begin() + std::ssize(leaves) / 2);
    if (round % 2 == 0) {
      std::erase_if(marked, [&](Index) { return random.below(one_in) != 0; });
      tables.refine(marked);
      continue;
    }
    std::erase_if(marked, [&](Index c) { return tables.mesh.host->cell(c).parent % 3 == 0; });
    tables.mix(random);
    merged += tables.coarsen(marked);
    for (char const stays : tables.blocks.stays) {
      some_stay = some_stay || stays != 0;
      all_stay = all_stay && stays != 0;
    }
  }
  CHECK(merged > 10);
  CHECK(some_stay);
  CHECK_FALSE(all_stay);
  tables.mix(random);
  while (tables.coarsen(tables.mesh.leaves()) > 0) {
  }
  CHECK(tables.mesh.leaves() == tables.mesh.first.cells);
  CHECK(tables.blocks.first == first_blocks);
  CHECK(rows_of() == first_rows);
}

TEST_CASE("elements refined in a backend's memory are those that the host makes", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_rounds(backend, distorted_mesh<Tri3>(80), 60, 5);
    check_rounds(backend, distorted_mesh<Quad4>(60), 40, 4);
    check_rounds(backend, distorted_mesh<Tet4>(10), 40, 4);
    check_rounds(backend, distorted_mesh<Hex8>(14), 30, 3);
    check_rounds(backend, distorted_mesh<Tet10>(5), 30, 3);
  });
}
TEST_CASE("elements coarsened in a backend's memory are those that the host makes", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_changes(backend, distorted_mesh<Tri3>(80), 20, 6);
    check_changes(backend, distorted_mesh<Quad4>(60), 20, 6);
    check_changes(backend, distorted_mesh<Tet4>(10), 15, 6);
    check_changes(backend, distorted_mesh<Hex8>(14), 15, 4);
    check_changes(backend, distorted_mesh<Tet10>(5), 8, 4);
  });
}
TEST_CASE("elements of single precision are those that the host makes, too", "[body]") {
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    check_rounds(backend, distorted_mesh<Tet4>(8), 40, 2);
    check_rounds(backend, distorted_mesh<Tri3>(40), 40, 2);
    check_changes(backend, distorted_mesh<Tet4>(8), 20, 4);
  });
}
#if defined(__CUDACC__)
TEST_CASE("fans of elements refined on a device are those of the host's tables", "[body]") {
  Tables<Cuda<double>, Tet4> tables(Cuda<double>{}, regular_mesh<Tet4>(20));
  tables.refine(tables.mesh.leaves());
  REQUIRE(tables.on.has_fans());
  auto leaves = tables.mesh.leaves();
  leaves.resize(500);
  tables.refine(leaves);
  CHECK(tables.on.has_fans());
  CHECK(std::ranges::count(tables.blocks.stays, 1) > 100);
  leaves = tables.mesh.leaves();
  leaves.resize(8000);
  CHECK(tables.coarsen(leaves) > 500);
  CHECK(tables.on.has_fans());
}
#endif

}  // namespace pliant::test::elements_on_suite

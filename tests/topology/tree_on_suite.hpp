#pragma once

#include "support/formulations.hpp"
#include "support/meshes.hpp"
#include "topology/trees_on.hpp"

// Trees in a backend's memory are refined as on the host.
namespace pliant::test::tree_on_suite {

/// Refines leaves at random, several times, here and on the host.
template <class B, class M>
void check_rounds(B const& backend, M const& mesh, std::size_t one_in, int rounds) {
  Hierarchy<M::dim> host(mesh);
  TreeBeside<B> on(backend, host);
  check_same(on.tree, host);
  HangingNodesOn<M::dim, B> hanging(backend), followed(backend);
  auto const find = [&](Index const* row_of_node) { return hanging.rows(on.tree, row_of_node); };
  check_hanging(backend, host, find);
  bool composed = false;
  Random random(3);
  for (int round = 0; round < rounds; ++round) {
    auto marked = some_leaves(host, one_in, random);
    random.shuffle(marked);
    marked.push_back(marked.front());
    auto const done = on.refine(marked);
    auto const wanted = host.refine(marked);
    REQUIRE(done.leaves == static_cast<Index>(wanted.parents.size()));
    CHECK(done.leaves >= static_cast<Index>(marked.size()) - 1);
    CHECK(numbers_of(on.taken(done.cells, done.leaves), &CellSplit::cell) == wanted.parents);
    REQUIRE(done.new_nodes == static_cast<Index>(wanted.new_nodes.size()));
    check_same(on.tree, host);
    check_hanging(backend, host, [&](Index const* row_of_node) {
      return followed.rows_after(on.tree, done, row_of_node);
    });
    if (round == 1) {  // another refinement, and back
      on.tree.keep();
      on.refine(some_leaves(host, 2, random));
      on.tree.take_back();
      check_same(on.tree, host);
    }
    on.tree.keep();
    check_hanging(backend, host, find);
    for (auto const& slave : host.slaves())
      composed = composed || slave.masters.size() == 3 || slave.masters.size() > 4;
  }
  if (std::same_as<M, Mesh<Tet4>>) CHECK(composed);
  CHECK(std::ranges::any_of(host.leaves(), [&](Index c) { return host.cell(c).level > 1; }));
}

TEST_CASE("trees of every cell are refined in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_rounds(backend, regular_mesh<Tri3>(5), 4, 4);
    check_rounds(backend, regular_mesh<Quad4>(5), 4, 4);
    check_rounds(backend, regular_mesh<Tet4>(2), 5, 4);
    check_rounds(backend, regular_mesh<Hex8>(3), 5, 3);
    check_rounds(backend, regular_mesh<Wedge6>(3), 5, 3);
    check_rounds(backend, regular_mesh<Pyramid5>(2), 5, 3);
    check_rounds(backend, mixed_mesh(4), 4, 4);
  });
}

TEST_CASE("trees of quadratic elements are refined in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_rounds(backend, mesh::raised<Tri6>(regular_mesh<Tri3>(4)), 4, 3);
    check_rounds(backend, mesh::raised<Quad9>(regular_mesh<Quad4>(4)), 4, 3);
    check_rounds(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(2)), 6, 3);
    check_rounds(backend, mesh::raised<Hex27>(regular_mesh<Hex8>(2)), 4, 3);
  });
}

TEST_CASE("a tree whose refinement would exceed a limit is as it was", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(mesh::raised<Tet10>(regular_mesh<Tet4>(2)));
    TreeBeside<B> on(backend, host);
    std::vector<Index> const marked{0, 7, 9};
    auto const more = Hierarchy<3>(host).refine(marked).new_nodes.size();
    RefinementLimits limits{.nodes = host.points().size() + more - 1};
    CHECK_THROWS_AS(on.refine(marked, limits), Error);
    check_same(on.tree, host);
    limits = {.leaves = host.leaf_count() + 3 * 7 - 1};
    CHECK_THROWS_AS(on.refine(marked, limits), Error);
    check_same(on.tree, host);
    ++limits.leaves;
    limits.nodes = host.points().size() + more;
    on.refine(marked, limits);
    host.refine(marked);
    check_same(on.tree, host);
    CHECK(on.refine({0}).leaves == 0);  // it is no leaf any more
    CHECK(on.refine({static_cast<Index>(host.cells().size()) - 1}, {.max_level = 1}).leaves == 0);
    check_same(on.tree, host);
  });
}

TEST_CASE("cells are refined as deep as levels go, and no deeper", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Tet4>(2));
    TreeBeside<B> on(backend, host);
    RefinementLimits limits{.max_level = most_levels};
    Index deepest = 0;
    for (; host.cell(deepest).level < most_levels; deepest = host.cell(deepest).first_child) {
      on.refine({deepest}, limits);
      host.refine(std::array{deepest}, limits);
    }
    check_same(on.tree, host);
    CHECK(on.refine({deepest}, limits).leaves == 0);
    CHECK(host.refine(std::array{deepest}, limits).parents.empty());
    ++limits.max_level;
    auto const says_how_many = says("at most 63");
    CHECK_THROWS_WITH(on.refine({deepest}, limits), says_how_many);
    CHECK_THROWS_WITH(host.refine(std::array{deepest}, limits), says_how_many);
    check_same(on.tree, host);
  });
}

TEST_CASE("refinements of a leaf are taken back wherever its edges and sides have parts",
          "[topology]") {
  auto const check = [](auto const& backend, auto host) {
    TreeBeside on(backend, host);
    Random random(5);
    for (int round = 0; round < 2; ++round) {  // what there is then is of many pages
      auto const marked = some_leaves(host, 3, random);
      on.refine(marked);
      host.refine(marked);
    }
    on.tree.keep();
    auto const leaves = host.leaves();
    for (int k = 0; k < 40; ++k) {
      CHECK(on.refine({leaves[random.below(leaves.size())]}).leaves > 0);
      on.tree.take_back();
    }
    check_same(on.tree, host);
  };
  on_each_backend<DoubleBackends>([&]<class B>(B const& backend) {
    check(backend, Hierarchy<2>(regular_mesh<Tri3>(20)));
    check(backend, Hierarchy<3>(regular_mesh<Tet4>(4)));
  });
}

TEST_CASE("a tree with more leaves than threads share is refined, and taken back", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<2> const before(regular_mesh<Tri3>(96));
    std::vector<Index> all(before.leaf_count());
    std::iota(all.begin(), all.end(), Index{0});
    TreeBeside<B> on(backend, before);
    REQUIRE(all.size() > std::size_t{TreeView::few});
    CHECK(on.refine(all).leaves == static_cast<Index>(all.size()));
    auto host = before;
    host.refine(all);
    check_same(on.tree, host);
    on.tree.take_back();
    check_same(on.tree, before);
  });
}

TEST_CASE("memory of a tree in a backend is used again", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Tet4>(4));
    TreeBeside<B> on(backend, host);
    std::size_t bytes = 0;
    for (int round = 0; round < 20; ++round) {
      on.refine({round, 2 * round, 100 + round});
      if (round == 0) bytes = on.tree.bytes();
      on.tree.take_back();
      CHECK(on.tree.bytes() == bytes);
    }
    check_same(on.tree, host);
  });
}

}  // namespace pliant::test::tree_on_suite

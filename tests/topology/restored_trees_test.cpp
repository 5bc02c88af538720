#include <pliant/mesh/box.hpp>

#include "support/catch.hpp"
#include "topology/tree_states.hpp"

// Trees that a limit refuses to change, or of which all is merged again, are as they were.
namespace pliant::test {

TEMPLATE_TEST_CASE("trees are as they were where nothing changed, and where all was undone",
                   "[topology]", Tet4, Hex8, Wedge6, Hex27) {
  Hierarchy<3> tree(mesh::box<TestType>({.size = {1, 1, 1}, .cells = {2, 3, 2}}));
  auto const state = [&] {
    return listed(tree.cells(), tree.tree().edges(), tree.tree().sides(), tree.tree().lists().rows,
                  tree.tree().divided(), tree.points());
  };
  auto const first = state();
  auto const any = [](TreeCell const&) { return true; };
  Random random(3);
  for (int round = 0; round < 3; ++round) {
    auto const marked = some_leaves(tree, 4, random, any);
    auto const before = state();
    CHECK_THROWS_AS(tree.refine(marked, {.nodes = tree.points().size()}), Error);
    CHECK(state() == before);
    REQUIRE(!tree.refine(marked).parents.empty());
    CHECK(state() != before);
  }
  for (auto parents = tree.families(tree.leaves()); !parents.empty();
       parents = tree.families(tree.leaves()))
    tree.merge(parents);
  CHECK(state() == first);
}

}  // namespace pliant::test

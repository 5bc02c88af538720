#include <pliant/mesh/box.hpp>

#include "support/catch.hpp"
#include "topology/tree_states.hpp"

// Trees are divided, raised and merged by several threads at once, and are the same whatever their number.
namespace pliant::test {

namespace {

/// Many random changes of a mesh of one element type; what came of each.
template <Element E>
std::vector<std::vector<Index>> changed(int threads_of_host) {
  HostThreads const threads(threads_of_host);
  Hierarchy<3> tree(mesh::box<E>({.size = {1, 1, 1}, .cells = {9, 9, 9}}));
  Random random(7);
  std::vector<std::vector<Index>> states;
  auto const note = [&](auto const& new_nodes) {
    auto& own =
        states.emplace_back(listed(tree.cells(), tree.tree().edges(), tree.tree().sides(),
                                   tree.tree().lists().rows, tree.tree().divided(), tree.points()));
    for (NewNode const& node : new_nodes) {
      own.push_back(node.node);
      for (auto const& [parent, weight] : node.parents) own.push_back(parent);
    }
  };
  auto const any = [](TreeCell const&) { return true; };
  auto const linear = [](TreeCell const& cell) { return cell.has == CellNodes::corners; };
  auto const lists_of = [](Hierarchy<3> const& of) {
    return listed(of.cells(), of.tree().edges(), of.tree().sides(), of.tree().lists().rows);
  };
  for (int round = 0; round < 2; ++round) {
    Hierarchy<3> const copy = tree;  // shares what does not change
    auto const before = lists_of(copy);
    note(tree.refine(some_leaves(tree, 2, random, any)).new_nodes);
    std::vector<CellConversion> raise;
    for (Index const c : some_leaves(tree, 3, random, linear)) raise.push_back({c, CellNodes::all});
    note(tree.raise(raise).new_nodes);
    std::vector<CellSplit> splits;
    if constexpr (std::same_as<typename E::cell, Hexahedron>)
      for (Index const c : some_leaves(tree, 5, random, linear))
        if (tree.cell(c).kind == CellKind::hexahedron)
          splits.push_back({c, Division::six_pyramids});
    note(tree.split(splits).new_nodes);
    auto const leaves = some_leaves(tree, 1, random, any);
    std::vector<Index> parents = tree.families(leaves);
    std::erase_if(parents, [&](Index) { return random.below(3) == 0; });
    auto lowered = some_leaves(tree, 5, random,
                               [](TreeCell const& cell) { return cell.has == CellNodes::all; });
    std::erase_if(
        lowered, [&](Index c) { return std::ranges::binary_search(parents, tree.cell(c).parent); });
    note(tree.merge(parents, lowered).gone);
    CHECK(lists_of(copy) == before);
  }
  return states;
}

}  // namespace

TEMPLATE_TEST_CASE("trees are the same whatever the number of threads", "[topology]", Tet4, Hex8,
                   Hex27) {
  auto const alone = changed<TestType>(1);
  REQUIRE(alone.size() == 8);
  for (int threads : {2, 5}) {
    auto const together = changed<TestType>(threads);
    for (std::size_t k = 0; k < alone.size(); ++k) CHECK(together[k] == alone[k]);
  }
}

TEST_CASE("cells beside divided ones are divided while a copy shares what these made",
          "[topology]") {
  auto const divided = [](int threads_of_host) {
    HostThreads const threads(threads_of_host);
    Hierarchy<3> tree(mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {12, 12, 12}}));
    std::vector<Index> even, odd;
    for (Index c = 0; c < 4000; ++c) (c % 2 == 0 ? even : odd).push_back(c);
    tree.refine(even);
    Hierarchy<3> const copy = tree;
    auto const lists_of = [](Hierarchy<3> const& of) {
      return listed(of.cells(), of.tree().edges(), of.tree().sides(), of.tree().lists().rows);
    };
    auto const before = lists_of(copy);
    tree.refine(odd);
    CHECK(lists_of(copy) == before);
    return lists_of(tree);
  };
  CHECK(divided(5) == divided(1));
}

}  // namespace pliant::test

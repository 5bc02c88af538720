#include <pliant/topology/facet_transfer.hpp>
#include <pliant/topology/facets_between.hpp>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "topology/tree_states.hpp"

// Facets that are taken over from a tree to another one are those that each change between them would give.
namespace pliant::test {

/// The same, of which every other one runs round the other way.
template <int Dim>
std::vector<Facet<Dim>> turned(std::vector<Facet<Dim>> facets) {
  for (std::size_t i = 0; i < facets.size(); i += 2) {
    auto* const nodes = facets[i].begin();
    auto const n = facets[i].corners();
    std::reverse(nodes + (Dim == 2 ? 0 : 1), nodes + n);
    if (Dim == 3 && facets[i].size() > n) std::reverse(nodes + n, nodes + 2 * n);
  }
  return facets;
}

template <class M>
void check_facets(M const& mesh, int rounds) {
  constexpr int dim = M::dim;
  using Facets = std::vector<Facet<dim>>;
  Hierarchy<dim> tree(mesh);
  Random random(3);
  auto const refine = [&](Facets const& facets) {
    auto leaves = tree.leaves();
    std::erase_if(leaves, [&](Index) { return random.below(4) != 0; });
    auto const done = tree.refine(leaves);
    return FacetTransfer<dim>(done.facets, {}).carry(facets, {}).value_or(facets);
  };
  auto const coarsen = [&](Facets const& facets) {
    auto leaves = tree.leaves();
    std::erase_if(leaves, [&](Index) { return random.below(30) == 0; });
    auto const done = tree.coarsen(leaves);
    CHECK(!done.parents.empty());
    return FacetTransfer<dim>({}, done.facets)
        .carry(facets, done.renumbered.nodes)
        .value_or(facets);
  };
  auto const first = refine(turned<dim>(mesh.boundary("left")));
  auto const before = tree;
  auto facets = first;
  std::size_t fewest = facets.size(), most = facets.size();
  for (int round = 0; round < rounds; ++round) {
    facets = round % 4 < 2 ? coarsen(facets) : refine(facets);
    FacetsBetween<dim> const between(before.tree().lists(), tree.tree().lists(), {&first});
    auto const found = between.carry(first);
    REQUIRE(found);
    CHECK(in_any_order<dim>(*found) == in_any_order<dim>(facets));
    fewest = std::min(fewest, facets.size());
    most = std::max(most, facets.size());
  }
  CHECK(fewest < first.size());
  CHECK(most > first.size());
}

TEST_CASE("facets of a tree are taken over to another one of the same mesh", "[topology]") {
  check_facets(regular_mesh<Tri3>(6), 8);
  check_facets(regular_mesh<Quad4>(6), 8);
  check_facets(regular_mesh<Tet4>(3), 8);
  check_facets(regular_mesh<Hex8>(4), 8);
  check_facets(mesh::raised<Tri6>(regular_mesh<Tri3>(6)), 8);
  check_facets(mesh::raised<Tet10>(regular_mesh<Tet4>(3)), 8);
  check_facets(mesh::raised<Hex27>(regular_mesh<Hex8>(4)), 8);
}

TEST_CASE("facets inside of divided cells are not taken over", "[topology]") {
  Hierarchy<2> tree(regular_mesh<Tri3>(4));
  tree.refine(std::vector<Index>{0});
  auto const child = tree.tree().row(tree.cell(0).first_child + 3);  // in the middle
  Facet<2> const inside{child.nodes[0], child.nodes[1]};
  std::vector<Facet<2>> const facets{inside};
  FacetsBetween<2> const between(tree.tree().lists(), tree.tree().lists(), {&facets});
  CHECK(!between.carry(facets));
}

}  // namespace pliant::test

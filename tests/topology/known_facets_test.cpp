#include <cmath>

#include <pliant/mesh/box.hpp>
#include <pliant/mesh/rectangle.hpp>
#include <pliant/topology/hierarchy.hpp>

#include "support/catch.hpp"
#include "support/elements.hpp"

// Of many sides that are divided or merged, those of the boundary and such inside as somebody knows are facets.
namespace pliant::test {

namespace {

template <int Dim>
bool is_in_plane(Facet<Dim> const& facet, SharedList<Point<Dim>> const& points, double x) {
  return std::ranges::all_of(facet, [&](Index node) {
    return std::abs(points[static_cast<std::size_t>(node)][0] - x) < 1e-12;
  });
}
template <int Dim>
std::vector<std::vector<Index>> sorted(std::vector<Facet<Dim>> const& facets) {
  std::vector<std::vector<Index>> keys;
  for (auto const& facet : facets) {
    auto& key = keys.emplace_back(facet.begin(), facet.end());
    std::ranges::sort(key);
  }
  std::ranges::sort(keys);
  return keys;
}

}  // namespace

TEMPLATE_TEST_CASE("facets inside that are known go over, others are left out", "[topology]", Tri3,
                   Quad4, Tet4, Hex8) {
  constexpr int dim = TestType::dim;
  using Facets = std::vector<Facet<dim>>;
  Hierarchy<dim> tree([] {
    if constexpr (dim == 2)
      return mesh::rectangle<TestType>({.size = {1, 1}, .cells = {60, 60}});
    else
      return mesh::box<TestType>({.size = {1, 1, 1}, .cells = {12, 12, 12}});
  }());
  auto const leaves = tree.leaves();

  auto all = tree;
  Facets middle, left;  // the sides in the middle, and those in the plane x = 0
  for (auto const& facet : all.refine(leaves).facets) {
    if (is_in_plane<dim>(facet.whole, tree.points(), 0.5)) middle.push_back(facet.whole);
    if (is_in_plane<dim>(facet.whole, tree.points(), 0)) left.push_back(facet.whole);
  }
  REQUIRE(!middle.empty());
  REQUIRE(middle.size() == left.size());
  KnownFacets<dim> const known({&middle});
  auto const nodes = static_cast<Index>(tree.points().size());
  auto const refined = tree.refine(leaves, {}, known);
  std::size_t inside = 0;
  for (auto const& facet : refined.facets)
    if (is_in_plane<dim>(facet.whole, tree.points(), 0.5)) ++inside;
  CHECK(inside == middle.size());
  auto const on_boundary =
      static_cast<std::size_t>(2 * dim) * left.size();  // of a cube, whose sides are alike
  CHECK(refined.facets.size() == on_boundary + middle.size());

  Transfer<dim> const finer(
      {.old_nodes = nodes, .new_nodes = refined.new_nodes, .divided = refined.facets});
  auto const parts = finer.carry_facets(middle);
  CHECK(parts.size() == (dim == 2 ? 2 : 4) * middle.size());
  for (auto const& part : parts) CHECK(is_in_plane<dim>(part, tree.points(), 0.5));

  // One part alone is enough for a side to be known, of a triangle the one in the middle too.
  Facets const one_part{parts.back()};
  auto again = tree;
  auto const families = tree.families(tree.leaves());
  auto const cut = again.merge(families, {}, KnownFacets<dim>({&one_part}));
  CHECK(cut.facets.size() == on_boundary + 1);
  CHECK(Transfer<dim>({.merged = cut.facets}).cut_facets(one_part).size() == (dim == 2 ? 2 : 4));

  KnownFacets<dim> const known_parts({&parts});
  auto const nodes_before = static_cast<Index>(tree.points().size());
  auto const merged = tree.merge(families, {}, known_parts);
  CHECK(merged.facets.size() == on_boundary + middle.size());
  Transfer<dim> const coarser(
      {.old_nodes = nodes_before, .renumbered = merged.renumbered.nodes, .merged = merged.facets});
  CHECK(sorted<dim>(coarser.carry_facets(parts)) == sorted<dim>(middle));
}

}  // namespace pliant::test

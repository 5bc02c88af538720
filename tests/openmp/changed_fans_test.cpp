#include <algorithm>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>

#include "support/formulations.hpp"

// Fans of a mesh that changes: blocks that stay keep theirs.
namespace pliant::test::changed_fans_test {

using Kirchhoff = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;

/// The elements of a layout in the order of their fans, each with the rows that it adds to and its nodes.
template <class Layout>
std::vector<std::array<Index, 9>> in_fans(Layout const& layout) {
  auto const& elements = std::get<0>(layout.tables).elements;
  auto const& fans = elements.fans();
  std::vector<std::array<Index, 9>> list;
  for (Index p = 0; p < elements.patch_count(); ++p)
    fans.for_each_element(p, [&](Index e, std::array<Index, 4> const& corners) {
      auto& own = list.emplace_back();
      own[8] = e;
      for (std::size_t a = 0; a < 4; ++a) {
        own[a] = fans.nodes()[corners[a]];
        own[4 + a] = fans.targets()[corners[a]];
      }
    });
  return list;
}

TEST_CASE("fans of a mesh that changed are those of a table made anew", "[openmp]") {
  auto const mesh = distorted_mesh<Tet4>(9);
  Body body{OpenMP<double>{{.threads = 1}}, mesh, soft, Group<Kirchhoff>{}};
  using Layout = decltype(body)::layout_type;
  Random random(11);
  std::size_t most = 0;
  for (int i = 0; i < 12; ++i) {
    auto const count = body.mesh().elements<Tet4>().size();
    most = std::max(most, count);
    std::vector<Index> marked;
    auto const levels = refinement_levels<Tet4>(body);
    bool const back = i % 3 == 2;
    for (std::size_t e = 0; e < count; ++e)
      if (back ? levels[e] > 0 && random.below(8) != 0 : random.below(200) == 0)
        marked.push_back(static_cast<Index>(e));
    if (back)
      coarsen(body, {marked});
    else
      refine(body, {marked});
    auto const& parts = body.parts();
    Layout const anew(parts.backend, *parts.state.topology, parts.material, parts.groups,
                      &parts.layout, parts.layout.node_rows);
    CHECK(in_fans(parts.layout) == in_fans(anew));
    std::vector<int> times(body.mesh().elements<Tet4>().size());
    for (auto const& own : in_fans(parts.layout)) {
      ++times[static_cast<std::size_t>(own[8])];
      auto const* const nodes = std::get<0>(parts.layout.tables).elements.nodes(own[8]);
      std::array<Index, 4> sorted{own[0], own[1], own[2], own[3]}, known;
      std::copy_n(nodes, 4, known.begin());
      std::ranges::sort(sorted);
      std::ranges::sort(known);
      if (sorted != known) FAIL("element " << own[8] << " has other nodes in its fan");
    }
    CHECK(times == std::vector<int>(times.size(), 1));
  }
  CHECK(most > 2 * 2048);
}

}  // namespace pliant::test::changed_fans_test

#pragma once

#include <cstdlib>

#include "topology/cells_at_edges.hpp"
#include "topology/level_jumps.hpp"
#include "topology/random_changes.hpp"
#include "topology/side_corners.hpp"

// Elements are refined, coarsened, raised, lowered, split, merged and switched at random, many times.
// PLIANT_CHANGES in the environment: how many times; 200 unless set.
namespace pliant::test::many_changes_suite {

/// How many nodes, cells, edges and sides a refinement tree has.
template <class TheBody>
std::array<std::size_t, 4> sizes(TheBody& body) {
  auto const& tree = body.parts().state.topology->tree->tree();
  return {static_cast<std::size_t>(tree.node_count()), tree.cells().size(), tree.edges().size(),
          tree.sides().size()};
}

/// Of a body that moves as one.
template <class TheBody>
void check_body(TheBody& body, Point<TheBody::dim> const& v) {
  CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-12));
  std::vector<bool> hangs(body.mesh().nodes.size(), false);
  for (auto const& slave : body.mesh().slaves) hangs[static_cast<std::size_t>(slave.node)] = true;
  auto const& mass = body.parts().layout.mass_list();
  int wrong = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) wrong += hangs[i] ? mass[i] != 0 : !(mass[i] > 0);
  CHECK(wrong == 0);
  CHECK(std::ranges::count(body.velocities(), v) == body.nodes());
  if (auto const& tree = body.parts().state.topology->tree) {
    CHECK(count_level_jumps(*tree) == 0);
    CHECK(count_other_corners(*tree) == 0);
    CHECK(count_edges_with_other_cells(*tree) == 0);
  }
}

TEST_CASE("bodies stay sound under many changes of their meshes", "[topology]") {
  char const* const wanted = std::getenv("PLIANT_CHANGES");
  int const changes = wanted != nullptr ? std::atoi(wanted) : 200;
  REQUIRE(changes > 0);
  on_each_backend<DoubleBackends>([&]<class B>(B const& backend) {
    auto const run = [&]<class P>(P) {
      auto body = P::body(backend);
      constexpr int dim = decltype(body)::dim;
      auto const mesh = body.mesh();
      auto const masses = body.parts().layout.mass_list();
      set_mesh_limits(body, {.nodes = P::most_nodes});
      Point<dim> v{};
      for (std::size_t k = 0; k < dim; ++k) v[k] = 0.3 - 0.7 * static_cast<double>(k);
      body.set_velocities(FieldOf<dim>(mesh.nodes.size(), v));
      Random random(4);
      std::array<std::size_t, 4> first_sizes{};
      int refused = 0;
      std::size_t largest_mesh = 0;
      for (int i = 1; i <= changes; ++i) {
        auto const nodes = body.nodes();
        try {
          change<P>(body, random);
        } catch (Error const& error) {
          CHECK_THAT(error.what(), Catch::Contains("the limit is"));
          CHECK(body.nodes() == nodes);
          ++refused;
          undo(body);
        }
        largest_mesh = std::max(largest_mesh, static_cast<std::size_t>(body.nodes()));
        check_body(body, v);
        if (i % 40 == 0) {
          check_continuity(body, random);
          body.set_displacements(FieldOf<dim>(body.mesh().nodes.size()));
        }
        if (i % 100 != 0 && i != changes) continue;
        undo(body);
        CHECK(body.mesh().nodes == mesh.nodes);
        CHECK(body.mesh().tables == mesh.tables);
        CHECK(body.mesh().boundaries == mesh.boundaries);
        CHECK(body.mesh().slaves.empty());
        CHECK(body.parts().layout.mass_list() == masses);
        check_body(body, v);
        if (first_sizes[0] == 0) first_sizes = sizes(body);
        CHECK(sizes(body) == first_sizes);
      }
      CHECK(largest_mesh > 2 * mesh.nodes.size());
      if (changes >= 1000) CHECK(refused > 0);
    };
    run(ChangingPlane{});
    run(ChangingSolid{});
  });
}

}  // namespace pliant::test::many_changes_suite

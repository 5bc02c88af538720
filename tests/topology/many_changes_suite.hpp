#pragma once

#include <cstdlib>

#include <pliant/mesh/with_types.hpp>

#include "support/meshes.hpp"
#include "topology/level_jumps.hpp"
#include "topology/mixed_meshes.hpp"

// Elements are refined, coarsened, raised, lowered, split, merged and switched at random, many times.
// PLIANT_CHANGES in the environment: how many times; 200 unless set.
namespace pliant::test::many_changes_suite {

struct Plane {
  using First = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
  using Second = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using Quads = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Quadratic = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
  static constexpr std::size_t most_nodes = 600;
  template <class B>
  static auto body(B const& backend) {
    return Body(backend, mesh::with_types<Tri3, Quad4, Quad9>(mixed_mesh(5, 1)), soft,
                Group<First>{}, Group<Second>{}, Group<Quads>{}, Group<Quadratic>{});
  }
};
struct Solid {
  using First = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  using Second = Formulation<Tet4, Gauss<1>, NeoHookean>;
  using Quadratic = Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>;
  using Hexes = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
  using Pyramids = Formulation<Pyramid5, Gauss<2>, SaintVenantKirchhoff>;
  static constexpr std::size_t most_nodes = 900;
  template <class B>
  static auto body(B const& backend) {
    return Body(backend, mesh::with_types<Tet4, Tet10, Hex8, Pyramid5>(distorted_mesh<Hex8>(3)),
                soft, Group<First>{}, Group<Second>{}, Group<Quadratic>{}, Group<Hexes>{},
                Group<Pyramids>{});
  }
};

/// The marks that are for types of which wanted(E{}).
template <class TheBody, class Wanted>
std::vector<std::vector<Index>> some_where(TheBody const& body, std::size_t one_in, Random& random,
                                           Wanted const& wanted) {
  auto lists = some(body, one_in, random, -1);
  detail::for_each_type_of(body.mesh(), [&](auto element, std::size_t type) {
    if (!wanted(element)) lists[type].clear();
  });
  return lists;
}
constexpr auto of_degree(int degree) {
  return [degree]<Element E>(E) { return E::degree == degree; };
}
template <class TheBody>
constexpr auto can_be_raised() {
  return []<Element E>(E) {
    return E::degree == 1 && converted_type<E, typename TheBody::mesh_type> != no_type;
  };
}
constexpr auto can_be_split() {
  return []<Element E>(E) { return !std::is_void_v<SplitInto<E>>; };
}
constexpr auto can_be_merged() {
  return []<Element E>(E) { return is_part<E>; };
}

template <class P, class TheBody>
void change(TheBody& body, Random& random) {
  switch (random.below(8)) {
    case 0:
    case 1:
      refine(body, some(body, 12, random, -1), 3);
      break;
    case 2:
      raise(body, some_where(body, 8, random, can_be_raised<TheBody>()),
            {.ring = static_cast<int>(random.below(2))});
      break;
    case 3:
      lower(body, some_where(body, 3, random, of_degree(2)));
      break;
    case 4:
      split(body, some_where(body, 4, random, can_be_split()),
            {.triangles = random.below(2) == 0 ? 2 : 4});
      break;
    case 5:
      merge(body, some_where(body, 1 + random.below(2), random, can_be_merged()));
      break;
    case 6:
      coarsen(body, some(body, 1 + random.below(2), random, -1));
      break;
    default: {
      auto const& triangles = body.mesh().template elements<typename P::First::element>();
      std::vector<Index> list;
      for (Index e = 0; e < static_cast<Index>(triangles.size()); ++e)
        if (random.below(3) == 0) list.push_back(e);
      if (random.below(2) == 0)
        body.template assign<typename P::First>(list);
      else
        body.template assign<typename P::Second>(list);
    }
  }
}
/// Back to the mesh of the beginning.
template <class TheBody>
void undo(TheBody& body) {
  Random random(1);
  for (std::size_t changed = 1; changed > 0;) {
    changed = lower(body, some_where(body, 1, random, of_degree(2))).lowered;
    changed += merge(body, some_where(body, 1, random, can_be_merged())).merged;
    changed += coarsen(body, all(body, -1)).merged;
  }
}

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
  auto const& mass = body.parts().layout.mass_list;
  int wrong = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) wrong += hangs[i] ? mass[i] != 0 : !(mass[i] > 0);
  CHECK(wrong == 0);
  CHECK(std::ranges::count(body.velocities(), v) == body.nodes());
  if (auto const& tree = body.parts().state.topology->tree) CHECK(count_level_jumps(*tree) == 0);
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
        check_body(body, v);
        if (first_sizes[0] == 0) first_sizes = sizes(body);
        CHECK(sizes(body) == first_sizes);
      }
      CHECK(largest_mesh > 2 * mesh.nodes.size());
      if (changes >= 1000) CHECK(refused > 0);
    };
    run(Plane{});
    run(Solid{});
  });
}

}  // namespace pliant::test::many_changes_suite

#pragma once

#include "adaptation/plane_bodies.hpp"

namespace pliant::test::refinement_inheritance_suite {

/// Whether a point lies in a convex, counter-clockwise element, its sides included.
template <class M, std::size_t N>
bool contains(M const& mesh, std::array<Index, N> const& element, Point<2> const& p) {
  for (std::size_t s = 0; s < N; ++s) {
    auto const &a = mesh.nodes[static_cast<std::size_t>(element[s])],
               &b = mesh.nodes[static_cast<std::size_t>(element[(s + 1) % N])];
    if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0) return false;
  }
  return true;
}

TEST_CASE("children are in the group of their parent", "[adaptation]") {
  on_plane_meshes<MainAlone>(6, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(5);
    put(body, random_marks(body, random, 2), Put::linear);
    auto const groups = [&body]<Element E>(E) { return body.template groups_of<E>(); };

    for (int round = 0; round < 3; ++round) {
      M const old = body.mesh();
      std::vector<std::vector<Tag>> old_groups;
      body.parts().for_each_type([&](auto const& table, auto const&) {
        old_groups.push_back(groups(typename std::remove_cvref_t<decltype(table)>::element{}));
      });

      refine(body, random_marks(body, random, 3));

      std::size_t which = 0;
      body.parts().for_each_type([&](auto const& table, auto const&) {
        using E = typename std::remove_cvref_t<decltype(table)>::element;
        auto const now = groups(E{});
        auto const& elements = body.mesh().template elements<E>();
        REQUIRE(now.size() == elements.size());
        for (std::size_t e = 0; e < elements.size(); ++e) {
          Point<2> centre{};
          for (Index n : elements[e])
            for (std::size_t k = 0; k < 2; ++k)
              centre[k] += body.mesh().nodes[static_cast<std::size_t>(n)][k] / E::nodes;
          auto const& parents = old.template elements<E>();
          auto const parent = std::ranges::find_if(
              parents, [&](auto const& nodes) { return contains(old, nodes, centre); });
          REQUIRE(parent != parents.end());
          CHECK(now[e] == old_groups[which][static_cast<std::size_t>(parent - parents.begin())]);
        }
        ++which;
      });
    }
  });
}

TEST_CASE("named boundaries and conditions on facets go over to the children", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.hold(mesh.boundary("top"), 2);
    body.drive(mesh.boundary("right"),
               [](double t) -> Point<2> {
                 return {0.01 * t, 0};
               },
               {.directions = 1});
    body.set_gravity({0.1, -0.2});
    Random random(5);

    for (int k = 0; k < 4; ++k) refine(body, random_marks(body, random, 3));

    struct Side {
      char const* name;
      std::size_t direction;
      double at, outward;
    };
    M const& now = body.mesh();
    for (auto const& [name, direction, at, outward] :
         {Side{"left", 0, -0.25, -1}, Side{"right", 0, 0.75, 1}, Side{"bottom", 1, 0.5, -1},
          Side{"top", 1, 1.5, 1}}) {
      INFO(name);
      std::vector<Index> on_it;
      for (std::size_t i = 0; i < now.nodes.size(); ++i)
        if (now.nodes[i][direction] == at) on_it.push_back(static_cast<Index>(i));
      CHECK(nodes_of(now.boundary(name)) == on_it);
      CHECK(now.boundary(name).size() == on_it.size() - 1);
      CHECK(on_it.size() > mesh.boundary(name).size() + 1);
      for (auto const& facet : now.boundary(name)) {  // the body lies to the left
        Index const a = facet[0], b = facet[1];
        auto const along = 1 - direction;
        double const run = now.nodes[static_cast<std::size_t>(b)][along] -
                           now.nodes[static_cast<std::size_t>(a)][along];
        CHECK(run * outward * (direction == 0 ? 1 : -1) > 0);
      }
    }
    REQUIRE(body.state().prescribed->conditions.size() == 3);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(now.boundary("left")));
    CHECK(body.state().prescribed->conditions[1].nodes == nodes_of(now.boundary("top")));
    CHECK(body.state().prescribed->conditions[2].nodes == nodes_of(now.boundary("right")));

    CentralDifference step;
    step(body, 30);
    auto const u = body.displacements();
    double const driven = 0.01 * body.time();
    for (std::size_t i = 0; i < u.size(); ++i) {
      bool const left = now.nodes[i][0] == -0.25, right = now.nodes[i][0] == 0.75,
                 top = now.nodes[i][1] == 1.5;
      if (left) CHECK(u[i] == Point<2>{0, 0});
      if (right) CHECK(u[i][0] == driven);
      if (!left && !right) CHECK(u[i][0] != 0);
      if (!left) CHECK((u[i][1] == 0) == top);
    }
  });
}

TEST_CASE("conditions and loads on nodes stay with these nodes", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    std::vector<Index> const held{2, 7, 11};
    body.clamp(held);
    body.set_load(5, {0.25, -0.5});
    Random random(5);

    for (int k = 0; k < 3; ++k) refine(body, random_marks(body, random, 3));

    CHECK(body.state().prescribed->conditions[0].nodes == held);
    REQUIRE(nodal_loads(body).size() == static_cast<std::size_t>(body.nodes()));
    for (std::size_t i = 0; i < nodal_loads(body).size(); ++i)
      CHECK(nodal_loads(body)[i] == (i == 5 ? Point<2>{0.25, -0.5} : Point<2>{}));
    double const dt = 1e-4;
    CentralDifference step{{.step = dt}};
    step(body);
    CHECK(body.displacements()[5][0] ==
          Approx(dt * dt / 2 * 0.25 / body.parts().layout.mass_list()[5]).epsilon(1e-12));
  });
}

TEST_CASE("facets and nodes may be held between refinements", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    body.clamp(mesh.boundary("left"));
    Random random(5);
    refine(body, random_marks(body, random, 3));
    auto const right = nodes_of(body.mesh().boundary("right"));

    body.clamp(right);
    body.hold(body.mesh().boundary("top"), 2);
    refine(body, random_marks(body, random, 3));

    auto const& conditions = body.state().prescribed->conditions;
    REQUIRE(conditions.size() == 3);
    CHECK(conditions[0].nodes == nodes_of(body.mesh().boundary("left")));
    CHECK(conditions[1].nodes == right);
    CHECK(conditions[2].nodes == nodes_of(body.mesh().boundary("top")));
  });
}

TEST_CASE("pressures stay on their facets when nodes are held between refinements",
          "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.press(mesh.boundary("top"), 1);
    body.press(mesh.boundary("bottom"), 2);
    Random random(5);
    refine(body, random_marks(body, random, 3));
    body.clamp(nodes_of(body.mesh().boundary("right")));

    refine(body, random_marks(body, random, 3));

    M const& now = body.mesh();
    REQUIRE(body.state().prescribed->pressures.size() == 2);
    CHECK(body.state().prescribed->pressures[0].facets == now.boundary("top"));
    CHECK(body.state().prescribed->pressures[0].pascals == 1);
    CHECK(body.state().prescribed->pressures[1].facets == now.boundary("bottom"));
    CHECK(body.state().prescribed->pressures[1].pascals == 2);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(now.boundary("left")));
  });
}

TEST_CASE("element-steps go on counting over refinements", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(5);
    CentralDifference step{{.step = 1e-4}};
    double expected = 0;

    for (int k = 1; k <= 3; ++k) {
      step(body, k);
      expected += k * static_cast<double>(element_count(body));
      refine(body, random_marks(body, random, 3));
    }

    double sum = 0;
    body.parts().for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      for (double steps : element_steps<E>(body)) sum += steps;
    });
    CHECK(sum == expected);
  });
}

}  // namespace pliant::test::refinement_inheritance_suite

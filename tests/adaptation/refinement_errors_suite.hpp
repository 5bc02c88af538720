#pragma once

#include "adaptation/plane_bodies.hpp"
#include "support/repeatable.hpp"

namespace pliant::test::refinement_errors_suite {

/// All that a user can see of a body; alike to the bit, but for what is added in no fixed order.
template <class TheBody>
struct Portrait {
  typename TheBody::mesh_type mesh;
  FieldOf<2> u, v, f;
  SharedList<double> masses;
  std::vector<std::vector<Tag>> groups;
  double strain, kinetic, time;
  long steps;
  std::size_t entries;

  explicit Portrait(TheBody& body)
      : mesh(body.mesh()),
        u(body.displacements()),
        v(body.velocities()),
        f(body.forces()),
        masses(body.parts().layout.mass_list()),
        strain(strain_energy(body)),
        kinetic(kinetic_energy(body)),
        time(body.time()),
        steps(body.steps()),
        entries(ledger(body).size()) {
    body.parts().for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      groups.push_back(body.template groups_of<E>());
    });
  }
  bool operator==(Portrait const& o) const {
    return mesh.nodes == o.mesh.nodes && mesh.tables == o.mesh.tables &&
           mesh.boundaries == o.mesh.boundaries && u == o.u && v == o.v && f == o.f &&
           masses == o.masses && groups == o.groups && strain == o.strain && kinetic == o.kinetic &&
           time == o.time && steps == o.steps && entries == o.entries;
  }
};

template <class B, class M>
auto moving_body(B const& backend, M const& mesh) {
  auto body = plane_body(backend, mesh);
  body.clamp(mesh.boundary("left"));
  Random random(5);
  refine(body, random_marks(body, random, 4));
  body.set_velocities(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.1));
  CentralDifference step{{.step = 1e-3}};
  step(body, 5);
  (void)body.velocities();
  return body;
}

TEST_CASE("a mesh that would grow beyond the capacity is an error and leaves the body",
          "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = moving_body(backend, mesh);
    auto twin = moving_body(backend, mesh);
    Portrait const before(body);
    Marks all;
    body.parts().for_each_type([&](auto const& table, auto const&) {
      all.emplace_back();
      for (Index e = 0; e < table.count(); ++e) all.back().push_back(e);
    });
    auto const elements = 4 * element_count(body);
    auto const nodes = [&] {
      auto grown = moving_body(backend, mesh);
      refine(grown, all);
      return static_cast<std::size_t>(grown.nodes());
    }();

    set_mesh_limits(body, {.nodes = nodes - 1});
    CHECK_THROWS_AS(refine(body, all), Error);
    set_mesh_limits(body, {.elements = elements - 1});
    CHECK_THROWS_AS(refine(body, all), Error);
    for (int const max_level : {-1, most_levels + 1})
      CHECK_THROWS_WITH(refine(body, all, max_level), says("at most 63"));

    CHECK(Portrait(body) == before);
    CentralDifference step{{.step = 1e-3}}, other_step{{.step = 1e-3}};
    step(body, 10);
    other_step(twin, 10);
    CHECK(Portrait(body) == Portrait(twin));
    set_mesh_limits(body, {.nodes = nodes, .elements = elements});
    CHECK_NOTHROW(refine(body, all));
    CHECK(element_count(body) == elements);
    CHECK(static_cast<std::size_t>(body.nodes()) == nodes);
  });
}

TEST_CASE("to refine an element that is not there is an error and leaves the body",
          "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = moving_body(backend, mesh);
    Portrait const before(body);
    std::size_t which = 0;
    body.parts().for_each_type([&](auto const& table, auto const&) {
      for (Index wrong : {-1, table.count(), table.count() + 1000}) {
        Marks marks(before.groups.size());
        marks[0] = {0};
        marks[which].push_back(wrong);
        CHECK_THROWS_AS(refine(body, marks), Error);
      }
      ++which;
    });
    CHECK(Portrait(body) == before);
  });
}

TEST_CASE("lists of marks that are too few or too many are an error and leave the body",
          "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = moving_body(backend, mesh);
    Portrait const before(body);
    std::size_t const types = before.groups.size();
    for (std::size_t wrong : {types - 1, types + 1})
      CHECK_THROWS_WITH(refine(body, Marks(wrong, {0})),
                        says("for " + std::to_string(wrong) + " element types") &&
                            says("the mesh has " + std::to_string(types)));
    CHECK(Portrait(body) == before);
  });
}

TEST_CASE("nothing marked, or only what is at its level, changes nothing", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = moving_body(backend, mesh);
    Portrait const before(body);
    Marks const none(before.groups.size());
    Marks one = none;
    one[0] = {0};

    auto const report = refine(body, none);
    refine(body, one, 0);

    CHECK(report.refined == 0);
    CHECK(report.new_nodes == 0);
    CHECK(Portrait(body) == before);
    refine(body, one);
    CHECK_FALSE(Portrait(body) == before);
  });
}

TEST_CASE("a state that is not finite is not refined", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = plane_body(backend, mesh);
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 10));
    take_steps(body.parts(), 1e3, 40);
    REQUIRE_FALSE(std::isfinite(largest(body.displacements())));

    CHECK_THROWS_AS(refine(body, {{0, 1}}), Error);

    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(body.nodes() == static_cast<Index>(mesh.nodes.size()));
    CHECK(ledger(body).empty());
  });
}

}  // namespace pliant::test::refinement_errors_suite

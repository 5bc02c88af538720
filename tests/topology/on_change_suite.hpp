#pragma once

#include <sstream>
#include <stdexcept>

#include "adaptation/plane_bodies.hpp"
#include "support/flat.hpp"
#include "support/keeps_trees.hpp"

namespace pliant::test::on_change_suite {

/// What a simulator that embeds a body keeps beside it.
struct Simulator {
  std::vector<double> temperature;            // of each node: linear in x
  std::vector<std::vector<Point<2>>> middle;  // of each element's first ancestor, by type
  int calls = 0;

  static double warmth(Point<2> const& x) { return 3 + 2 * x[0] - x[1]; }
  template <class M>
  explicit Simulator(M const& mesh) {
    for (auto const& x : mesh.nodes) temperature.push_back(warmth(x));
    middle = middles(mesh);
  }
  template <class M>
  static std::vector<std::vector<Point<2>>> middles(M const& mesh) {
    std::vector<std::vector<Point<2>>> all(std::tuple_size_v<decltype(M::tables)>);
    for_each_element(mesh, [&]<Element E>(E, std::size_t, auto const& nodes) {
      Point<2> centre{};
      for (Index n : nodes)
        for (std::size_t k = 0; k < 2; ++k)
          centre[k] += mesh.nodes[static_cast<std::size_t>(n)][k] / E::nodes;
      all[all.size() > 1 && std::same_as<E, Quad4> ? 1 : 0].push_back(centre);
    });
    return all;
  }
  template <class M>
  void follow(TopologyChange<M> const& change) {
    ++calls;
    CHECK(temperature.size() == change.before.mesh().nodes.size());
    temperature = change.transfer.carry_nodes(std::move(temperature));
    for (std::size_t type = 0; type < middle.size(); ++type)
      middle[type] = change.transfer.carry_elements(middle[type], type);
    CHECK(temperature.size() == change.after.mesh().nodes.size());
  }
};

TEST_CASE("topologies share the boundaries that a change leaves as they are", "[topology]") {
  auto const mesh = regular_mesh<Quad4>(4);
  auto body = body_of<Formulation<Quad4, Gauss<2>, Hooke>>(Reference<double>{}, mesh);
  int shared = 0, changed = 0;
  body.on_change([&](TopologyChange<Mesh<Quad4>> const& change) {
    for (auto const& [name, before] : change.before.boundaries()) {
      auto const& after = change.after.boundaries().at(name);
      CHECK((after == before) == (*after == *before));
      ++(after == before ? shared : changed);
    }
  });
  refine(body, {{0}});  // in a corner
  CHECK(shared == 2);
  CHECK(changed == 2);
  std::vector<Index> children;
  auto const levels = refinement_levels<Quad4>(body);
  for (std::size_t e = 0; e < levels.size(); ++e)
    if (levels[e] > 0) children.push_back(static_cast<Index>(e));
  coarsen(body, {children});
  CHECK(shared == 4);
  CHECK(changed == 4);
}

TEST_CASE("a simulator's own arrays follow the mesh of a body", "[topology]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Simulator simulator(mesh);
    body.on_change([&](TopologyChange<M> const& change) {
      CHECK(&change.after.mesh() == &body.mesh());
      simulator.follow(change);
    });
    auto const first = simulator.middle;
    Random random(3);
    int const rounds = 3;
    for (int k = 0; k < rounds; ++k) refine(body, random_marks(body, random, 3));

    CHECK(simulator.calls == rounds);
    REQUIRE(simulator.temperature.size() == static_cast<std::size_t>(body.nodes()));
    for (std::size_t i = 0; i < simulator.temperature.size(); ++i)
      CHECK(simulator.temperature[i] ==
            Approx(Simulator::warmth(body.mesh().nodes[i])).epsilon(1e-14));
    // Each element is inside the one that it descends from.
    auto const now = Simulator::middles(body.mesh());
    for (std::size_t type = 0; type < now.size(); ++type) {
      REQUIRE(simulator.middle[type].size() == now[type].size());
      for (std::size_t e = 0; e < now[type].size(); ++e) {
        auto const& ancestor = simulator.middle[type][e];
        CHECK(std::ranges::find(first[type], ancestor) != first[type].end());
        CHECK(std::hypot(now[type][e][0] - ancestor[0], now[type][e][1] - ancestor[1]) < 0.2);
      }
    }
    (void)refine(body, Marks(std::tuple_size_v<decltype(M::tables)>));
    CHECK(simulator.calls == rounds);  // nothing changed
  });
}

TEST_CASE("forces of arrays that a simulator carried over are those of the body", "[topology]") {
  on_plane_meshes<AllBackends>(4, []<class B, class M>(B const& backend, M const& mesh) {
    using T = typename B::scalar;
    auto body = plane_body(backend, mesh);
    auto u = rounded<T>(Random(4).field<2>(mesh.nodes.size(), 0.02));
    body.set_displacements(u);
    body.on_change([&](auto const& change) { u = change.transfer.carry_nodes(std::move(u)); });
    Random random(3);
    for (int k = 0; k < 2; ++k) refine(body, random_marks(body, random, 3));

    auto const at = upload(backend, flat<T>(u));
    auto f = upload(backend, flat<T>(FieldOf<2>(u.size())));
    body.add_force(at.data(), f.data());

    auto const own = body.forces();
    double const rounding = 4096 * epsilon_of<decltype(body)>;
    REQUIRE(u.size() == own.size());
    CHECK(difference(per_node<2>(download<T>(f)), own) < rounding * largest(own));
  });
}

TEST_CASE("a listener on a backend asks for no other change and no other listener", "[topology]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    for (bool const on_host : {false, true}) {
      auto body = plane_body(backend, distorted_mesh<Tri3>(5));
      if (on_host) change_on_host(body);
      int told = 0;
      body.on_backend_change([&](auto const& change) {
        ++told;
        CHECK(change.nodes() == body.nodes());
        CHECK_THROWS_WITH(refine(body, {{1}}), says("change of the mesh: a listener"));
        CHECK_THROWS_WITH(coarsen(body, {{1}}), says("change of the mesh: a listener"));
        CHECK_THROWS_WITH(body.on_backend_change([](auto const&) {}),
                          says("on_backend_change: a listener"));
        CHECK(change.nodes() == body.nodes());
      });
      refine(body, {{0}});
      CHECK(told == 1);
    }
  });
}

TEST_CASE("a listener asks for no other change and no other listener", "[topology]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    for (bool const on_host : {false, true}) {
      auto body = plane_body(backend, distorted_mesh<Tri3>(5));
      if (on_host) change_on_host(body);
      std::ostringstream saved(std::ios::binary);
      body.save(saved);
      auto const before = saved.str();
      int told = 0;
      bool asks = true;
      body.on_change([&](auto const& change) {
        ++told;
        CHECK(change.after.nodes() == body.nodes());
        if (!asks) return;
        auto const nodes = body.nodes();
        CHECK_THROWS_WITH(refine(body, {{1}}), says("change of the mesh: a listener"));
        CHECK_THROWS_WITH(coarsen(body, {{1}}), says("change of the mesh: a listener"));
        CHECK_THROWS_WITH(body.on_change([](auto const&) {}), says("on_change: a listener"));
        std::istringstream file(before, std::ios::binary);
        CHECK_THROWS_WITH(body.load(file), says("load: a listener"));
        CHECK(body.nodes() == nodes);
        throw std::runtime_error("asked");
      });
      CHECK_THROWS_WITH(refine(body, {{0}}), says("asked"));
      CHECK(told == 1);
      asks = false;
      int also_told = 0;
      body.on_change([&](auto const&) { ++also_told; });
      refine(body, {{1}});
      CHECK(told == 2);
      CHECK(also_told == 1);
    }
  });
}

/// The strain along x of an element.
struct Longer {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.gradient()(0, 0);
  }
};

TEST_CASE("a listener is called once for a refinement by rules", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(5);
    auto body = plane_body(backend, mesh);
    Adaptation adapt{when<TriRubber>(Longer{}).above(0.2).refine({.max_level = 1})};
    Simulator simulator(mesh);
    body.on_change([&](auto const& change) { simulator.follow(change); });
    body.set_displacements(uniform(mesh.nodes, Tensor<double, 2>{{{0.3, 0}, {0, 0}}}));

    adapt.now(body);

    CHECK(simulator.calls == 1);
    CHECK(simulator.temperature.size() == static_cast<std::size_t>(body.nodes()));
    CHECK(body.nodes() > static_cast<Index>(mesh.nodes.size()));
  });
}

TEST_CASE("pressures and conditions follow a refinement at work", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {3, 3}});
    auto body = body_of<QuadRubber>(backend, mesh);
    body.clamp(mesh.boundary("bottom"));
    auto const pressed = body.press(mesh.boundary("top"), 0.5);
    auto const pull = [&] {
      auto const with = body.forces();
      auto const& pressures = body.state().prescribed->pressures;
      REQUIRE(pressures.size() == 1);
      CHECK(pressures[0].facets == body.mesh().boundary("top"));
      return total(with)[1];
    };
    CHECK(pull() == Approx(-0.5).epsilon(1e-14));

    refine(body, {{6, 8}});
    CHECK(pull() == Approx(-0.5).epsilon(1e-14));
    refine(body, {{7, 8, 9, 10}});
    CHECK(pull() == Approx(-0.5).epsilon(1e-14));

    CHECK(body.press(body.mesh().boundary("top"), 0.25) == pressed);
    CHECK(pull() == Approx(-0.25).epsilon(1e-14));
    body.release(pressed);
    CHECK(largest(body.forces()) == 0);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(body.mesh().boundary("bottom")));
  });
}

TEST_CASE("a body of the mesh of a refined one has the same energy and forces", "[topology]") {
  on_plane_meshes<MainAlone>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto refined = plane_body(backend, mesh);
    Random random(3);
    for (int k = 0; k < 3; ++k) refine(refined, random_marks(refined, random, 4));
    REQUIRE_FALSE(refined.mesh().slaves.empty());
    auto const u = Random(4).field<2>(static_cast<std::size_t>(refined.nodes()), 0.002);

    auto plain = refined.mesh();
    auto again = plane_body(backend, plain);
    std::ranges::reverse(plain.slaves);  // their masters are free: any order is one
    auto reversed = plane_body(backend, plain);

    auto const f = forces_at(refined, u);
    for (auto* other : {&again, &reversed}) {
      CHECK(difference(forces_at(*other, u), f) < 1e-13 * largest(f));
      CHECK(other->displacements() == refined.displacements());
      CHECK(strain_energy(*other) == Approx(strain_energy(refined)).epsilon(1e-13));
      CHECK(other->parts().layout.mass_list() == refined.parts().layout.mass_list());
      CHECK_THROWS_WITH(other->clamp(std::vector<Index>{plain.slaves[0].node}),
                        says("hangs between others"));
      CHECK_THROWS_WITH(refine(*other, random_marks(*other, random, 4)), says("hanging nodes"));
    }
    plain.slaves.clear();  // a crack, if nobody says so
    CHECK_THROWS_WITH(plane_body(backend, plain), says("hangs on the edge"));
  });
}

}  // namespace pliant::test::on_change_suite

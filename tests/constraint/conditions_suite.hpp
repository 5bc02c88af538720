#pragma once

#include "support/formulations.hpp"

namespace pliant::test::conditions_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Solid = Formulation<Hex8, Gauss<2>, NeoHookean>;

inline Mesh<Quad4> strip() { return mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}); }
inline auto drawn_at(double speed) {
  return [speed](double t) { return Point<2>{speed * t, 0}; };
}
template <class Field>
auto at(Field const& field, Index node) {
  return field[static_cast<std::size_t>(node)];
}

TEST_CASE("one condition rotates a face rigidly", "[constraint]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {3, 3, 3}});
    auto body = body_of<Solid>(backend, mesh);
    body.clamp(mesh.boundary("bottom"));
    auto const turned = [](Point<3> const& x, double t) {
      double const angle = 0.3 * t, c = std::cos(angle) - 1, s = std::sin(angle);
      double const p = x[0] - 0.5, q = x[1] - 0.5;
      return Point<3>{c * p - s * q, s * p + c * q, 0};
    };
    body.drive(mesh.boundary("top"), turned);
    CentralDifference step{{.step = 0.01}};

    step(body, 60);

    auto const u = body.displacements(), v = body.velocities();
    double const middle = body.time() - 0.005;  // of the last step
    for (Index i : nodes_of(mesh.boundary("top"))) {
      Point<3> const x = at(mesh.nodes, i), to = turned(x, body.time());
      CHECK(at(u, i) == rounded<T>(FieldOf<3>{to})[0]);
      Point<3> const m = turned(x, middle);
      double const epsilon = 1e-5 + 400 * double{std::numeric_limits<T>::epsilon()};
      CHECK(at(v, i)[0] == Approx(-0.3 * (x[1] - 0.5 + m[1])).margin(epsilon));
      CHECK(at(v, i)[1] == Approx(0.3 * (x[0] - 0.5 + m[0])).margin(epsilon));
    }
    CHECK(strain_energy(body) > 0);
  });
}

TEST_CASE("a frictionless plate moves a face normally and leaves it free along itself",
          "[constraint]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.drive(mesh.boundary("right"),
               [](double t) {
                 return Point<2>{-0.2 * t, 99};
               },
               {.directions = 1});
    CentralDifference step{{.step = 0.01}};

    step(body, 50);

    auto const u = body.displacements();
    double const to = rounded<T>(FieldOf<1>{{-0.2 * body.time()}})[0][0];
    double bulge = 0;
    for (Index i : nodes_of(mesh.boundary("right"))) {
      CHECK(at(u, i)[0] == to);
      bulge = std::max(bulge, std::abs(at(u, i)[1]));
    }
    CHECK(bulge > 1e-3);
    CHECK(bulge < 0.25);
  });
}

TEST_CASE("a released node moves again, and a driven one goes on at its speed", "[constraint]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    auto const held = body.clamp(mesh.boundary("left"));
    auto const driven = body.drive(mesh.boundary("right"), drawn_at(0.25));
    CentralDifference step{{.step = 1.0 / 256}};
    step(body, 64);
    auto const before = body.velocities();
    for (Index i : nodes_of(mesh.boundary("right"))) CHECK(at(before, i) == Point<2>{0.25, 0});

    body.release(driven);
    CHECK(body.velocities() == before);
    body.release(held);
    CHECK(body.velocities() == before);
    step(body, 64);

    for (Index i : nodes_of(mesh.boundary("left"))) CHECK(at(body.displacements(), i)[0] != 0);
    for (Index i : nodes_of(mesh.boundary("right"))) {
      CHECK(at(body.velocities(), i)[0] != 0.25);
      CHECK(at(body.displacements(), i)[1] != 0);
    }
    CHECK_THROWS_WITH(body.release(held), says("body.release: handle 0") && says("before"));
    CHECK_THROWS_WITH(body.release(driven), says("handle 1"));
    CHECK_THROWS_WITH(body.release(Handle{}), says("handle -1"));
    CHECK_THROWS_WITH(body.reactions(held), says("body.reactions: handle 0"));
  });
}

TEST_CASE("a new condition leaves the speed of other driven nodes alone", "[constraint]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    body.drive(mesh.boundary("right"), drawn_at(0.25));
    CentralDifference step{{.step = 1.0 / 256}};
    step(body, 16);
    auto const before = body.velocities();

    body.clamp(mesh.boundary("left"));
    body.drive(std::vector<Index>{4}, drawn_at(0.125), {.directions = 1});

    auto const v = body.velocities();
    for (Index i : nodes_of(mesh.boundary("right"))) CHECK(at(v, i) == Point<2>{0.25, 0});
    for (Index i : nodes_of(mesh.boundary("left"))) CHECK(at(v, i) == Point<2>{});
    CHECK(at(v, 4)[0] == 0);
    CHECK(at(v, 4)[1] == at(before, 4)[1]);
  });
}

TEST_CASE("conditions that contradict each other are refused, and the body is as it was",
          "[constraint][errors]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    body.hold(std::vector<Index>{0, 9}, 1);
    body.drive(std::vector<Index>{8}, drawn_at(0.1), {.directions = 1});
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.01));
    CentralDifference step{{.step = 1e-3}};
    step(body, 5);
    auto const all = [&] {
      auto const& prescribed = *body.state().prescribed;
      return std::tuple(download<double>(body.state().u), download<double>(body.state().v),
                        body.time(), body.state().pending_half_kick, prescribed.conditions.size(),
                        prescribed.next_id, body.parts().motions.size(),
                        download<DirectionMask>(body.parts().layout.held));
    };
    auto const before = all();

    CHECK_THROWS_WITH(body.drive(std::vector<Index>{3, 9}, drawn_at(1)),
                      says("node 9 is to be driven") && says("holds it"));
    CHECK_THROWS_WITH(body.drive(std::vector<Index>{8, 3}, drawn_at(1)),
                      says("node 8 is to be driven") && says("drives it"));
    CHECK_THROWS_WITH(body.clamp(std::vector<Index>{3, 8}),
                      says("node 8 is to be held") && says("drives it"));
    CHECK((all() == before));

    body.hold(std::vector<Index>{8}, 2);  // directions that are free may be held,
    body.drive(std::vector<Index>{9}, drawn_at(0), {.directions = 2});
    body.clamp(std::vector<Index>{0});  // and what is held may be held again
    CHECK(body.state().prescribed->conditions.size() == 5);
  });
}

TEST_CASE("a condition needs nodes, directions and facets of the mesh", "[constraint][errors]") {
  auto const mesh = strip();
  auto body = body_of<Rubber>(MainBackend{}, mesh);
  using Nodes = std::vector<Index>;
  using Facets = std::vector<Facet<2>>;
  CHECK_THROWS_WITH(body.clamp(Nodes{}), says("names no node"));
  CHECK_THROWS_WITH(body.clamp(Facets{}), says("names no node"));
  CHECK_THROWS_WITH(body.drive(Nodes{}, drawn_at(1)), says("names no node"));
  CHECK_THROWS_WITH(body.drive(Facets{}, drawn_at(1)), says("names no node"));
  CHECK_THROWS_WITH(body.hold(Nodes{1}, 0), says("directions 0") && says("at least one of 2"));
  CHECK_THROWS_WITH(body.hold(Nodes{1}, 4), says("directions 4"));
  CHECK_THROWS_WITH(body.drive(Nodes{1}, drawn_at(1), {.directions = 5}), says("directions 5"));
  CHECK_THROWS_WITH(body.drive(Nodes{1}, Motion<2>{}), says("the motion is empty"));
  CHECK_THROWS_WITH(body.clamp(Facets{{0, 1}, {0, 10}}),
                    says("facet with the nodes 0 10 is no side of an element"));
  CHECK_THROWS_WITH(body.clamp(Facets{{0, 99}}), says("node 99") && says("0 to 26"));
  CHECK_THROWS_WITH(body.clamp(Facets{{0}}), says("nodes 0 has too few"));
  CHECK(body.state().prescribed->conditions.empty());
}

TEST_CASE("facets told by their corners hold the nodes between these too", "[constraint]") {
  auto const mesh = mesh::rectangle<Quad9>({.size = {1, 1}, .cells = {2, 2}});
  auto body = body_of<Formulation<Quad9, Gauss<3>, NeoHookean>>(MainBackend{}, mesh);
  std::vector<Facet<2>> corners;
  for (auto const& facet : mesh.boundary("left")) corners.push_back({facet[1], facet[0]});
  body.clamp(corners);
  CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(mesh.boundary("left")));
}

TEST_CASE("motions have names of their own", "[constraint][errors]") {
  auto body = body_of<Rubber>(MainBackend{}, strip());
  auto const pull = body.drive(std::vector<Index>{0}, drawn_at(1), {.name = "pull"});
  CHECK_THROWS_WITH(body.drive(std::vector<Index>{1}, drawn_at(1), {.name = "pull"}),
                    says("a motion called \"pull\" already"));
  CHECK(body.state().prescribed->conditions.size() == 1);
  body.drive(std::vector<Index>{1}, drawn_at(1));
  body.drive(std::vector<Index>{2}, drawn_at(1));
  CHECK(body.parts().motions.size() == 3);
  body.release(pull);  // its name is free again
  body.drive(std::vector<Index>{0}, drawn_at(2), {.name = "pull"});
  CHECK(body.parts().motions.at("pull")({}, 1) == Point<2>{2, 0});
}

TEST_CASE("names that are made up are none that was given", "[constraint]") {
  auto body = body_of<Rubber>(MainBackend{}, strip());
  for (int k : {1, 2, 4})
    body.drive(std::vector<Index>{static_cast<Index>(k)}, drawn_at(1),
               {.name = "motion " + std::to_string(k)});
  for (Index node : {5, 6, 7}) body.drive(std::vector<Index>{node}, drawn_at(2));
  CHECK(body.parts().motions.size() == 6);
  CHECK(body.parts().motions.at("motion 4")({}, 1) == Point<2>{1, 0});
}

TEST_CASE("a motion that turns NaN stops a run before anything changes", "[constraint][errors]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const ends = [](double t) { return Point<2>{t < 0.0405 ? t : NAN, 0}; };
    auto const grows = [](Point<2> const&, double t) {
      return Point<2>{t < 0.0405 ? t : 1e39, 0};  // too large for single precision
    };
    bool const is_float = sizeof(T) == 4;
    for (bool by_place : {false, true}) {
      auto const make = [&] {
        auto body = body_of<Rubber>(backend, strip());
        body.drive(std::vector<Index>{3, 5}, drawn_at(0.5));
        if (by_place && is_float)
          body.drive(std::vector<Index>{0, 9}, grows);
        else if (by_place)
          body.drive(std::vector<Index>{0, 9},
                     [ends](Point<2> const&, double t) { return ends(t); });
        else
          body.drive(std::vector<Index>{0, 9}, ends);
        body.set_gravity({0, -1});
        return body;
      };
      auto stopped = make(), whole = make();
      CentralDifference first{{.step = 1e-3}}, second{{.step = 1e-3}};

      CHECK_THROWS_WITH(first(stopped, 100), says("the motion of node 0") && says("finite"));
      second(whole, 40);

      CHECK(stopped.steps() == 40);
      CHECK(stopped.time() == whole.time());
      CHECK(download<T>(stopped.state().u) == download<T>(whole.state().u));
      CHECK(download<T>(stopped.state().v) == download<T>(whole.state().v));
      CHECK(stopped.state().pending_half_kick == whole.state().pending_half_kick);
      CHECK_THROWS_AS(first(stopped), Error);
      CHECK(stopped.velocities() == whole.velocities());
    }
    auto body = body_of<Rubber>(backend, strip());
    auto const nowhere = [](double) { return Point<2>{0, -INFINITY}; };
    CHECK_THROWS_WITH(body.drive(std::vector<Index>{7}, nowhere), says("node 7"));
    CHECK(body.state().prescribed->conditions.empty());
    CHECK(body.parts().motions.empty());
  });
}

TEST_CASE("conditions on facets of a refined mesh are inherited by its refinements",
          "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    refine(body, {{0, 7, 15}});
    body.clamp(body.mesh().boundary("left"));
    auto const driven = body.drive(body.mesh().boundary("right"), drawn_at(0.25));
    auto const coarse = body.state().prescribed->conditions[1].nodes.size();
    std::vector<Index> marked;
    auto const& elements = body.mesh().template elements<Quad4>();
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (at(body.mesh().nodes, elements[e][1])[0] == 1) marked.push_back(static_cast<Index>(e));
    refine(body, {marked});

    auto const right = nodes_of(body.mesh().boundary("right"));
    CHECK(right.size() > coarse);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(body.mesh().boundary("left")));
    CHECK(body.state().prescribed->conditions[1].nodes == right);
    CentralDifference step{{.step = 1e-3}};
    step(body, 5);
    for (Index i : right) CHECK(at(body.displacements(), i)[0] == Approx(0.25 * body.time()));
    body.release(driven);
    CHECK_THROWS_WITH(body.clamp(mesh.boundary("right")),
                      says("is no side of an element") && says("after a refinement"));
  });
}

TEST_CASE("nodes that hang are not to be held or driven", "[constraint][errors]") {
  auto body = body_of<Rubber>(MainBackend{}, strip());
  refine(body, {{3}});
  REQUIRE_FALSE(body.mesh().slaves.empty());
  Index const hanging = body.mesh().slaves[0].node;
  CHECK_THROWS_WITH(body.clamp(std::vector<Index>{hanging}), says("hangs between others"));
  CHECK_THROWS_WITH(body.drive(std::vector<Index>{hanging}, drawn_at(1)), says("hangs"));
}

}  // namespace pliant::test::conditions_suite

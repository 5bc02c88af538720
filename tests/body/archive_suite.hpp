#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>

#include "support/formulations.hpp"

namespace pliant::test::archive_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

struct NoAdaptation {
  void operator()(auto&) const {}
};
/// A body and what advances it.
template <class TheBody, class Adapt = NoAdaptation>
struct Run {
  TheBody body;
  CentralDifference step{};
  Adapt adapt{};
  std::vector<Handle> handles{};
};
template <class TheBody>
Run(TheBody, CentralDifference = CentralDifference{}) -> Run<TheBody>;
template <class TheBody, class Adapt>
Run(TheBody, CentralDifference, Adapt) -> Run<TheBody, Adapt>;

template <class TheBody>
std::string saved(TheBody const& body) {
  std::ostringstream stream(std::ios::binary);
  body.save(stream);
  return stream.str();
}
template <class TheBody>
void load(TheBody& body, std::string const& bytes) {
  std::istringstream stream(bytes, std::ios::binary);
  body.load(stream);
}

/// Checks that bodies are the same to the bit, in their states and in all that can be read of them.
template <class TheBody>
void check_same(TheBody& a, TheBody& b) {
  CHECK(first_difference(a.state(), b.state()) == "");
  CHECK(a.time() == b.time());
  CHECK(a.steps() == b.steps());
  CHECK(booked_energy(a.parts()) == booked_energy(b.parts()));
  CHECK(a.displacements() == b.displacements());
  CHECK(a.velocities() == b.velocities());
  CHECK(strain_energy(a) == strain_energy(b));
  CHECK(total_energy(a) == total_energy(b));
  CHECK(first_difference(a.state(), b.state()) == "");
}

/// Runs `before + after` rounds, and beside it as many of which the last ones are those of a body that was
/// made anew and loads what the first ones left.
template <class Make, class Round>
void check_restart(Make const& make, Round const& round, int before, int after) {
  INFO("saved after round " << before);
  auto whole = make(), first = make(), second = make();
  for (int k = 0; k < before; ++k) {
    round(whole, k);
    round(first, k);
  }
  auto const bytes = saved(first.body);
  CHECK(first_difference(whole.body.state(), first.body.state()) == "");
  load(second.body, bytes);
  CHECK(first_difference(first.body.state(), second.body.state()) == "");
  CHECK(saved(second.body) == bytes);
  second.handles = first.handles;
  for (int k = before; k < before + after; ++k) {
    round(whole, k);
    round(second, k);
  }
  CHECK(std::isfinite(largest(whole.body.displacements())));
  CHECK(largest(whole.body.displacements()) > 0);
  check_same(whole.body, second.body);
}

TEST_CASE("a restart of a body goes on with the same bits", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto const make = [&] {
      Run run{body_of<Rubber>(backend, mesh), CentralDifference{{.check_interval = 10}}};
      run.body.clamp(mesh.boundary("left"));
      run.body.set_gravity({0.1, -0.5});
      run.body.set_damping(0.3);
      return run;
    };
    auto const round = [](auto& run, int) { run.step(run.body, 3); };
    for (int before : {0, 1, 3, 4, 11}) check_restart(make, round, before, 13);
  });
}

TEST_CASE("a restart goes on with the same bits while elements change groups", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto const make = [&] {
      Body body{backend, mesh, soft, Group<Linear>{}, Group<Rubber>{}};
      Adaptation adapt{when<Linear>(Rotation{}).above(0.05).template become<Rubber>(),
                       when<Rubber>(Rotation{}).below(0.04).template become<Linear>()};
      Run run{std::move(body), CentralDifference{{.check_interval = 16}},
              std::move(adapt).every(5)};
      run.body.clamp(mesh.boundary("left"));
      run.body.set_gravity({0, -0.07});
      return run;
    };
    auto const round = [](auto& run, int) {
      run.step(run.body);
      run.adapt(run.body);
    };
    for (int before : {4, 16, 33, 47}) check_restart(make, round, before, 40);
    auto run = make();
    bool mixed = false;
    for (int k = 0; k < 60; ++k) {
      round(run, k);
      auto const linear = std::ranges::count(run.body.template groups_of<Quad4>(), Tag{0});
      mixed = mixed || (linear > 3 && linear < 27);
    }
    CHECK(mixed);
  });
}

TEST_CASE("a restart goes on with the same bits on meshes that were refined", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = mixed_mesh(4);
    using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const make = [&] {
      Body body{backend, mesh, soft, Group<Triangles>{}, Group<Linear>{}, Group<Rubber>{}};
      Run run{std::move(body), CentralDifference{{.check_interval = 7}},
              Adaptation{when<Linear>(Rotation{}).above(0.02).template become<Rubber>(),
                         when<Triangles>(ForceIntensity<>{})
                             .above_fraction_of_largest(0.7)
                             .refine({.max_level = 3})}
                  .every(9)};
      run.body.clamp(mesh.boundary("left"));
      run.body.press(mesh.boundary("right"), 0.05);
      run.body.set_load(3, {0.01, -0.02});
      set_mesh_limits(run.body, {.nodes = 400});
      return run;
    };
    auto const round = [](auto& run, int k) {
      run.step(run.body);
      if (k == 5) refine(run.body, {{0, 3}, {1, 2}});
      run.body.set_load(3, {0.01, -0.02 - 0.001 * k});
      if (run.body.nodes() < 100) run.adapt(run.body);
    };
    for (int before : {3, 6, 11, 30}) check_restart(make, round, before, 25);
    auto run = make();
    for (int k = 0; k < 30; ++k) round(run, k);
    CHECK(run.body.nodes() > 60);
  });
}

TEST_CASE("a body that was refined takes back a state of its first mesh, and others", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = mixed_mesh(4);
    using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;
    Body body{backend, mesh, soft, Group<Triangles>{}, Group<Rubber>{}};
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step;
    step(body, 5);
    auto const coarse = saved(body);
    refine(body, {{1}, {2}});
    step(body, 5);
    auto const fine = saved(body);
    CHECK(fine.size() > coarse.size());

    load(body, coarse);
    CHECK(body.nodes() == static_cast<Index>(mesh.nodes.size()));
    CHECK(saved(body) == coarse);
    refine(body, {{1}, {2}});
    step(body, 5);
    CHECK(saved(body) == fine);
    load(body, coarse);
    load(body, fine);
    CHECK(saved(body) == fine);
    refine(body, {{0}, {0}});  // the tree is there
    step(body, 5);
    CHECK(std::isfinite(total_energy(body)));
  });
}

TEST_CASE("a restart goes on with the same bits under laws with internal variables", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    using Viscous = Formulation<Quad4, Gauss<2>, KelvinVoigt<NeoHookean>::law>;
    using Relaxing = Formulation<Tri3, Gauss<1>, Prony<NeoHookean>::law>;
    auto const mesh = mixed_mesh(4);
    NeoHookean<double> const rubber = NeoHookean<double>::from(soft);
    auto const make = [&] {
      Body body{backend, mesh, soft, Group<Relaxing>{{{rubber, {0.4}, {0.2}}}},
                Group<Viscous>{{{rubber, 0.02}}}};
      Run run{std::move(body), CentralDifference{{.check_interval = 9, .refresh_interval = 20}}};
      run.body.clamp(mesh.boundary("bottom"));
      run.body.set_gravity({0.3, -0.5});
      return run;
    };
    auto const round = [](auto& run, int) { run.step(run.body, 2); };
    for (int before : {0, 1, 5, 12}) check_restart(make, round, before, 16);
  });
}

/// A point that moves to and fro.
inline Motion<2> sway(double size) {
  return [size](double t) { return Point<2>{size * (1 - std::cos(5 * t)), 0}; };
}

TEST_CASE("a restart goes on with the same bits where nodes are driven, pressed and released",
          "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto const make = [&] {
      Run run{body_of<Rubber>(backend, mesh), CentralDifference{{.check_interval = 5}}};
      auto& body = run.body;
      run.handles = {body.drive(mesh.boundary("left"), sway(0.02), {.name = "sway"}),
                     body.drive(mesh.boundary("right"),
                                [](Point<2> const& x, double t) {
                                  return Point<2>{0, 0.01 * x[1] * std::sin(3 * t)};
                                },
                                {.directions = 2, .name = "shear"}),
                     body.press(mesh.boundary("top"), 0.1)};
      return run;
    };
    auto const round = [&](auto& run, int k) {
      auto& body = run.body;
      if (k == 6) body.release(run.handles[0]);
      if (k == 8) body.press(mesh.boundary("top"), 0.02);
      if (k == 10) run.handles[0] = body.hold(mesh.boundary("left"), 1);
      if (k == 12) body.release(run.handles[2]);
      if (k == 14) body.release(run.handles[1]);
      if (k == 16) run.handles[2] = body.press(mesh.boundary("bottom"), 0.05);
      if (k == 18) body.set_damping(0.5);
      run.step(body, 3);
    };
    for (int before : {2, 7, 9, 11, 13, 15, 17, 19}) check_restart(make, round, before, 20);
  });
}

TEST_CASE("a restart after a roll-back, and before one, goes on with the same bits", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto const make = [&] {
      auto body = body_of<Rubber>(backend, mesh);
      double const stable = stable_step(body);
      Run run{std::move(body), CentralDifference{{.step = 3.9 * stable, .check_interval = 32}}};
      run.body.clamp(mesh.boundary("left"));
      run.body.set_gravity({0, -0.05});
      return run;
    };
    auto const round = [](auto& run, int) { run.step(run.body, 5); };
    auto run = make();
    int first = 0;
    while (run.step.retries() == 0 && first < 40) round(run, first++);
    REQUIRE(run.step.retries() > 0);
    for (int before : {first - 1, first, first + 1}) check_restart(make, round, before, 15);
    CHECK(run.body.state().integrator.slower > 1);
  });
}

TEST_CASE("what a user does between a load and the next step is booked as without it", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    auto const make = [&] { return Run{body_of<Rubber>(backend, mesh)}; };
    auto const round = [&](auto& run, int k) {
      if (k == 3)
        run.body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
      else
        run.body.set_load(2, {0.1 * k, 0.2});
      run.step(run.body, 4);
    };
    check_restart(make, round, 3, 5);
  });
}

TEST_CASE("a state goes from one backend to another of the same precision", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = body_of<Rubber>(Reference<double>{}, mesh);
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step;
    step(body, 7);
    refine(body, {{2, 5}});
    step(body, 7);
    auto other = body_of<Rubber>(backend, mesh);
    load(other, saved(body));
    CHECK(saved(other) == saved(body));
    CHECK(other.displacements() == body.displacements());
  });
}

/// Checks that a body refuses bytes with a message that has a part, and stays as it was.
template <class TheBody>
void check_refused(TheBody& body, std::string const& bytes, std::string const& part) {
  auto const before = saved(body);
  CHECK_THROWS_WITH(load(body, bytes), says(part));
  CHECK(saved(body) == before);
}

TEST_CASE("streams that are no whole saved states are refused and nothing changes", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(3);
    auto body = body_of<Rubber>(backend, mesh), other = body_of<Rubber>(backend, mesh);
    other.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step;
    step(body, 3);
    step(other, 5);
    auto const whole = saved(other);

    check_refused(body, "", "no state");
    check_refused(body, "something else than a state, though long enough for one", "no state");
    for (std::size_t size = 1; size < whole.size(); size += size < 40 ? 1 : 97)
      check_refused(body, whole.substr(0, size), "ends before");
    check_refused(body, whole.substr(0, whole.size() - 1), "ends before");
    for (std::size_t k = 0; k < whole.size(); k += k < 40 ? 1 : 89) {
      INFO("byte " << k);
      auto damaged = whole;
      damaged[k] = static_cast<char>(damaged[k] ^ (1 << k % 8));
      check_refused(body, damaged,
                    k < 8    ? "no state"
                    : k < 12 ? "version"
                    : k < 20 ? ""
                             : "damaged");
    }
    auto later = whole;
    later[8] = static_cast<char>(later[8] + 1);
    check_refused(body, later, "this is version 22");

    load(body, whole);  // the whole one is good
    CHECK(saved(body) == whole);
  });
}

TEST_CASE("a stream goes on behind the state that it holds", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(3);
    auto body = body_of<Rubber>(backend, mesh);
    std::stringstream stream(std::ios::binary | std::ios::in | std::ios::out);
    body.save(stream);
    body.set_gravity({1, 0});
    body.save(stream);
    stream << "end";
    body.load(stream);
    CHECK(body.state().gravity == Point<2>{0, 0});
    body.load(stream);
    CHECK(body.state().gravity == Point<2>{1, 0});
    std::string rest;
    stream >> rest;
    CHECK(rest == "end");
    CHECK_THROWS_AS(body.load(stream), Error);
    stream.setstate(std::ios::failbit);
    CHECK_THROWS_AS(body.save(stream), Error);
  });
}

TEST_CASE("a state of another body is refused, and the message says what differs", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Quad4>(3);
    NeoHookean<double> const rubber = NeoHookean<double>::from(soft);
    auto harder = rubber;
    harder.mu *= 1 + 1e-15;
    Body body{backend, mesh, soft, Group<Rubber>{{rubber}}};
    auto const refused = [&](auto other, char const* part) {
      check_refused(body, saved(other), part);
    };
    auto moved = mesh;
    moved.nodes[2][0] = std::nextafter(moved.nodes[2][0], 10);

    refused(Body{backend, moved, soft, Group<Rubber>{{rubber}}}, "mesh");
    refused(Body{backend, mesh, soft, Group<Rubber>{{harder}}}, "parameters");
    refused(Body{backend, mesh, soft, Group<Rubber>{}}, "those of the material");
    refused(Body{backend, mesh, Elastic{5.2, 0.3, 1.6}, Group<Rubber>{{rubber}}}, "material");
    refused(Body{backend, mesh, soft, Group<Linear>{}}, "Hooke");
    refused(
        Body{backend, mesh, soft, Group<Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>>{{rubber}}},
        "FBar");
    refused(Body{backend, mesh, soft, Group<Rubber>{{rubber}}, Group<Linear>{}}, "group 1");
    refused(Body{backend, mixed_mesh(3), soft, Group<Rubber>{{rubber}},
                 Group<Formulation<Tri3, Gauss<1>, Hooke>>{}},
            "Mesh<Tri3,Quad4>");
    refused(Body{Reference<std::conditional_t<sizeof(T) == 4, double, float>>{}, mesh, soft,
                 Group<Rubber>{{rubber}}},
            "float");
    refused(body_of<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, distorted_mesh<Hex8>(3)),
            "dimension");
  });
}

TEST_CASE("a state whose motions the body was not given is refused by name", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(3);
    auto body = body_of<Rubber>(backend, mesh), other = body_of<Rubber>(backend, mesh);
    other.drive(mesh.boundary("left"), sway(0.1), {.name = "sway of the left side"});
    auto const bytes = saved(other);
    check_refused(body, bytes, "\"sway of the left side\"");
    body.release(body.drive(mesh.boundary("top"), sway(0.1), {.name = "sway of the left side"}));
    load(body, bytes);
    CHECK(saved(body) == bytes);
  });
}

TEST_CASE("comparison names the first member that differs", "[body]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(3);
    auto a = body_of<Rubber>(backend, mesh), b = body_of<Rubber>(backend, mesh);
    CHECK(same_state(a.state(), b.state()));
    b.set_velocities(Random(1).field<2>(mesh.nodes.size(), 1e-300));
    CHECK(first_difference(a.state(), b.state()) == "velocities");
    CHECK_FALSE(same_state(a.state(), b.state()));
    b.clamp(mesh.boundary("left"));
    CHECK(first_difference(a.state(), b.state()) == "conditions and pressures");
    refine(b, {{0}});
    CHECK(first_difference(a.state(), b.state()) == "topology");
    auto c = body_of<Rubber>(backend, mesh);
    c.parts().state.integrator.scale = NAN;
    CHECK(first_difference(a.state(), c.state()) == "integrator: scale");
    a.parts().state.integrator.scale = NAN;
    CHECK(same_state(a.state(), c.state()));
  });
}

}  // namespace pliant::test::archive_suite

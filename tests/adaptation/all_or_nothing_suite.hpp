#pragma once

#include <pliant/law/decorators/viscosity.hpp>

#include "adaptation/plane_bodies.hpp"

namespace pliant::test::all_or_nothing_suite {

/// The same for every element.
struct Constant {
  double value;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    return typename State::scalar(static_cast<builtin_scalar<typename State::scalar>>(value));
  }
};

TEST_CASE("a check whose refinement exceeds the capacity changes nothing", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto const elements = mesh.elements<Quad4>().size();
    auto const make = [&] {
      Body body{backend, mesh, soft, Group<QuadRubber>{}, Group<QuadLinear>{}};
      body.set_gravity({0, -1});
      body.set_displacements(Random(3).field<2>(mesh.nodes.size(), 0.01));
      body.template assign<QuadLinear>({1, 2, 5});
      CentralDifference step;
      step(body, 3);
      body.velocities();  // those of the present time: part of the energy is of all elements together
      Adaptation{when<QuadLinear>(Constant{1}).above(0.5).budget(1).template become<QuadRubber>()}
          .now(body);
      step(body, 2);
      body.velocities();
      return body;
    };
    auto body = make(), twin = make();
    set_mesh_limits(body, {.elements = elements + 3});
    auto const rubber = when<QuadRubber>(EdgeLengthRatio{}).above(0.0);
    Adaptation adapt{rubber.budget(6).template become<QuadLinear>(),
                     when<QuadLinear>(EdgeLengthRatio{}).top_share(1).refine()};
    auto const groups = body.template groups_of<Quad4>();
    auto const steps = element_steps<Quad4>(body);
    auto const switches = switch_counts<Quad4>(body);
    auto const entries = ledger(body);
    REQUIRE(entries.size() == 2);  // the switches and what groups that change together add

    measure_adaptation(body);
    CHECK_THROWS_AS(adapt.now(body), Error);

    auto& timers = body.parts().timers;
    CHECK(timers.migration.seconds() > 0);
    timers = {};
    CHECK(element_count(body) == elements);
    CHECK(body.template groups_of<Quad4>() == groups);
    CHECK(element_steps<Quad4>(body) == steps);
    CHECK(switch_counts<Quad4>(body) == switches);
    REQUIRE(ledger(body).size() == entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      CHECK(ledger(body)[i].elements == entries[i].elements);
      CHECK(ledger(body)[i].strain_energy == entries[i].strain_energy);
      CHECK(ledger(body)[i].kinetic_energy == entries[i].kinetic_energy);
    }
    CentralDifference step, other_step;
    step(body, 5);
    other_step(twin, 5);
    CHECK(difference(body.displacements(), twin.displacements()) <= 1e-13);

    set_mesh_limits(body, {});
    adapt.now(body);
    CHECK(ledger(body).size() == 4);
    CHECK(element_count(body) > elements + 3);
  });
}

TEST_CASE("a check that moves no element keeps no copy of the body", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    Body body{backend, mesh, soft, Group<QuadRubber>{}, Group<QuadLinear>{}};
    auto const kept = [&] {
      std::size_t size = 0;
      body.parts().for_each_type(
          [&](auto const& table, auto const&) { size = table.criteria.kept.tags.size(); });
      return size;
    };
    auto const look = [&](double threshold) {
      Adaptation{when<QuadRubber>(Constant{1}).above(threshold).template become<QuadLinear>(),
                 when<QuadLinear>(Constant{1}).above(9).refine()}
          .now(body);
    };

    look(2);
    CHECK(kept() == 0);
    look(0.5);
    CHECK(kept() == mesh.elements<Quad4>().size());
  });
}

TEST_CASE("internal variables too are as before a check that throws", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using First = Formulation<Quad4, Gauss<2>, Prony<SaintVenantKirchhoff>::law>;
    using Second = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
    auto const mesh = distorted_mesh<Quad4>(5);
    auto const make = [&] {
      Body body{backend, mesh, soft,
                Group<First>{typename First::template law<double>{{3, 2}, {0.5}, {0.1}}},
                Group<Second>{typename Second::template law<double>{{30, 20}, {0.5}, {0.1}}}};
      body.set_displacements(Random(3).field<2>(mesh.nodes.size(), 0.02));
      CentralDifference step;
      step(body, 20);
      return body;
    };
    auto body = make(), twin = make();
    set_mesh_limits(body, {.elements = mesh.elements<Quad4>().size()});
    Adaptation adapt{when<First>(Constant{1}).above(0).template become<Second>(),
                     when<Second>(Constant{1}).above(0).refine()};

    CHECK_THROWS_AS(adapt.now(body), Error);

    take_steps(body.parts(), 1e-4, 20);
    take_steps(twin.parts(), 1e-4, 20);
    CHECK(largest(twin.velocities()) > 1e-3);
    CHECK(difference(body.displacements(), twin.displacements()) <= 1e-13);
    CHECK(difference(body.velocities(), twin.velocities()) <= 1e-12);
  });
}

}  // namespace pliant::test::all_or_nothing_suite

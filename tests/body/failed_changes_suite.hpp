#pragma once

#include <sstream>
#include <stdexcept>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"
#include "support/spring.hpp"

// Changes that fail half way leave the body as it was.
namespace pliant::test::failed_changes_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <class TheBody>
std::string saved(TheBody const& body) {
  std::ostringstream stream(std::ios::binary);
  body.save(stream);
  return stream.str();
}

enum class Made { well, null, by_throwing };

/// Springs which are made as `made` says at that moment.
template <class B>
auto springs(Made const& made) {
  return [&made](B const& b, NodeRows const& rows) {
    if (made == Made::by_throwing) throw std::runtime_error("no springs");
    std::unique_ptr<AnyForceTerm<B, 2>> term;
    if (made == Made::well)
      term = std::make_unique<ConnectedTerm<B, Spring>>(
          b, std::vector<std::array<Index, 2>>{{rows.of_node[0], rows.of_node[8]}},
          Spring<double>{20}, rows.count());
    return term;
  };
}

template <class B>
auto swinging(B const& backend, Made const& made) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  Body body{backend, mesh, soft, Group<Rubber>{}, Group<Linear>{}};
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"),
             [](double t) -> Point<2> {
               return {0.01 * t, 0};
             },
             {.directions = 1, .name = "pull"});
  body.press(mesh.boundary("top"), 0.1);
  body.set_gravity({0, -0.1});
  body.set_load(12, {0.01, 0.02});
  body.add(springs<B>(made));
  return body;
}

/// Checks that `change` throws and leaves a body alone, and that a run then goes on as that of a twin.
template <class TheBody, class Change>
void check_refused(TheBody& body, TheBody& twin, Change const& change) {
  CentralDifference step, other;
  step(body, 11);
  other(twin, 11);
  (void)body.velocities();
  (void)twin.velocities();
  auto const before = saved(body);
  auto const forces = body.forces();
  auto const nodes = body.nodes();

  CHECK_THROWS(change());

  CHECK(body.nodes() == nodes);
  bool const same = saved(body) == before;
  CHECK(same);
  CHECK(difference(body.forces(), forces) <= between_runs(1e-12));
  step(body, 30);
  other(twin, 30);
  CHECK(difference(body.displacements(), twin.displacements()) <= between_runs(1e-12));
  CHECK(difference(body.velocities(), twin.velocities()) <= between_runs(1e-11));
}

TEST_CASE("a force term that cannot be made anew leaves the body as it was", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (Made how : {Made::null, Made::by_throwing}) {
      Made made = Made::well, well = Made::well;
      auto body = swinging(backend, made), twin = swinging(backend, well);
      auto const failing = [&](auto const& change) {
        return [&] {
          made = how;
          change();
        };
      };
      SECTION("refined") {
        check_refused(body, twin, failing([&] { refine(body, {{2, 5}}); }));
      }
      SECTION("refined by a check that switches too") {
        Adaptation adapt{when<Rubber>(AreaRatio{}).above(-1).budget(3).template become<Linear>(),
                         when<Linear>(AreaRatio{}).above(-1).refine()};
        Adaptation none{when<Rubber>(AreaRatio{}).above(9).template become<Linear>()};
        none.now(body);  // starts the statistics
        none.now(twin);
        check_refused(body, twin, failing([&] { adapt.now(body); }));
      }
      SECTION("loaded") {
        auto other = swinging(backend, well);
        refine(other, {{1}});
        std::istringstream file(saved(other), std::ios::binary);
        check_refused(body, twin, failing([&] { body.load(file); }));
      }
    }
  });
}

TEST_CASE("a term that is never made is refused", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Made well = Made::well, null = Made::null;
    auto body = swinging(backend, well);
    using Make = typename std::remove_cvref_t<decltype(body.parts())>::MakeTerm;
    CHECK_THROWS_WITH(body.add(springs<B>(null)), says("no force term"));
    CHECK_THROWS_WITH(body.add(Make{}), says("empty"));
    CHECK(body.parts().terms.size() == 1);
  });
}

TEST_CASE("a check whose listener throws is done all the same", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Made well = Made::well;
    auto body = swinging(backend, well), twin = swinging(backend, well);
    body.on_change([](auto const&) { throw std::runtime_error("no space"); });
    int told = 0;
    twin.on_change([&](auto const&) { ++told; });
    Adaptation adapt{when<Rubber>(AreaRatio{}).above(-1).budget(3).template become<Linear>(),
                     when<Linear>(AreaRatio{}).above(-1).refine()};
    CentralDifference step, other;
    step(body, 11);
    other(twin, 11);

    CHECK_THROWS_AS(adapt.now(body), std::runtime_error);
    adapt.now(twin);

    CHECK(told == 1);
    CHECK(body.nodes() == twin.nodes());
    CHECK(body.template groups_of<Quad4>() == twin.template groups_of<Quad4>());
    CHECK(ledger(body).size() == ledger(twin).size());
    CHECK(booked_energy(body.parts()) ==
          Approx(booked_energy(twin.parts())).margin(between_runs(1e-12)));
    step(body, 30);
    other(twin, 30);
    CHECK(difference(body.displacements(), twin.displacements()) <= between_runs(1e-12));
  });
}

}  // namespace pliant::test::failed_changes_suite

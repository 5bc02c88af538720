#pragma once

#include <sstream>

#include "support/formulations.hpp"

// Several Adaptations of one body look each in their own time.
namespace pliant::test::several_adaptations_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

/// Whether an element begins to the right of a place.
struct RightOf {
  double place;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    return select(S(builtin_scalar<S>(place)) < e.rest(0, 0), S(1), S(0));
  }
};

template <class B>
auto square_of_two_laws(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {4, 4}});
  return Body{backend, mesh, soft, Group<Linear>{}, Group<Turning>{}};
}
template <class TheBody>
long in_turning(TheBody const& body) {
  auto const groups = body.template groups_of<Quad4>();
  return std::ranges::count(groups, 1);
}
/// How many elements are in the other group when both have been called after each of four steps.
template <class B, class One, class Other>
long after_both(B const& backend, One one, Other other) {
  auto body = square_of_two_laws(backend);
  one.every(2);
  other.every(2);
  CentralDifference step;
  for (int k = 0; k < 4; ++k) {
    step(body);
    one(body);
    other(body);
  }
  CHECK(body.state().record.looks.size() == 2);
  return in_turning(body);
}

TEST_CASE("Adaptations whose rules differ in anything look each in their own time",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const to_turning = [](auto const& marked) {
      return Adaptation{marked.template become<Turning>()};
    };
    SECTION("kind of marking") {
      auto const look = when<Linear>(RightOf{-9});
      CHECK(after_both(backend, to_turning(look.above(2)), to_turning(look.below(2))) == 16);
    }
    SECTION("the last digits of a number") {
      auto const look = when<Linear>(RightOf{-9});
      CHECK(after_both(backend, to_turning(look.above(1)), to_turning(look.above(1 - 1e-12))) ==
            16);
    }
    SECTION("stay") {
      auto const look = when<Linear>(RightOf{-9}).above(0.5);
      CHECK(after_both(backend, to_turning(look.stay(99)), to_turning(look)) == 16);
    }
    SECTION("data of criteria") {
      CHECK(after_both(backend, to_turning(when<Linear>(RightOf{9}).above(0.5)),
                       to_turning(when<Linear>(RightOf{-9}).above(0.5))) == 16);
    }
    SECTION("level") {
      auto body = square_of_two_laws(backend);
      auto const look = when<Linear>(RightOf{-9}).above(0.5);
      Adaptation none{look.refine({.max_level = 0})}, once{look.refine({.max_level = 1})};
      none.every(2);
      once.every(2);
      CentralDifference step;
      for (int k = 0; k < 2; ++k) {
        step(body);
        none(body);
        once(body);
      }
      CHECK(body.mesh().template elements<Quad4>().size() == 64);
    }
  });
}

TEST_CASE("an Adaptation made anew goes on with the last look of the one that is gone",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = square_of_two_laws(backend);
    CentralDifference step;
    for (int k = 0; k < 8; ++k) {
      CHECK(in_turning(body) == 0);
      step(body);
      Adaptation{when<Linear>(RightOf{-9}).above(0.5).template become<Turning>()}(body);
    }
    CHECK(in_turning(body) == 16);
    CHECK(body.state().record.looks.size() == 1);
  });
}

TEST_CASE("Adaptations of a run that is loaded look when those that were saved would have",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const rule = [](double place) {
      return Adaptation{when<Linear>(RightOf{place}).above(0.5).template become<Turning>()}.every(
          5);
    };
    // They look at steps 5, 10, ..., and, first called two steps later, at steps 7, 12, ...
    auto const run = [&](auto& body, auto& one, auto& other, int steps) {
      CentralDifference step;
      for (int k = 0; k < steps; ++k) {
        step(body);
        one(body);
        if (body.steps() > 2) other(body);
      }
    };
    std::stringstream file;
    {
      auto body = square_of_two_laws(backend);
      auto one = rule(9), other = rule(-9);
      run(body, one, other, 5);
      body.save(file);
    }
    auto body = square_of_two_laws(backend);
    body.load(file);
    auto one = rule(9), other = rule(-9);
    run(body, one, other, 1);
    CHECK(in_turning(body) == 0);
    run(body, one, other, 1);
    CHECK(in_turning(body) == 16);
    CHECK(body.state().record.looks.size() == 2);
  });
}

}  // namespace pliant::test::several_adaptations_suite

#pragma once

#include "adaptation/plane_bodies.hpp"

// Elements that may not act take nothing of a rule's budget, share or bulk.
namespace pliant::test::candidates_suite {

/// Where an element begins, along x; positive.
struct BeginOfElement {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.rest(0, 0) + typename State::scalar(1);
  }
};

template <class B>
auto linear_square(B const& backend, Index cells) {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {cells, cells}});
  return Body{backend, mesh, soft, Group<QuadLinear>{}, Group<QuadRubber>{}};
}
template <class TheBody>
long in_rubber(TheBody const& body) {
  auto const groups = body.template groups_of<Quad4>();
  return std::ranges::count(groups, 1);
}

TEST_CASE("elements at the finest level take nothing of a budget, share or bulk", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const look = when<QuadLinear>(BeginOfElement{});
    auto const refine_all = [&](auto const& rule) {
      auto body = linear_square(backend, 4);
      Adaptation adapt{rule};
      for (int k = 0; k < 16; ++k) adapt.now(body);
      CHECK(body.mesh().template elements<Quad4>().size() == 64);
    };
    SECTION("budget") { refine_all(look.above(-10).budget(2).refine({.max_level = 1})); }
    SECTION("share") { refine_all(look.top_share(1).budget(1).refine({.max_level = 1})); }
    SECTION("bulk") { refine_all(look.bulk(0.01).refine({.max_level = 1})); }
  });
}

TEST_CASE("elements that have to stay take nothing of a budget", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = linear_square(backend, 4);
    Adaptation there{
        when<QuadLinear>(BeginOfElement{}).above(-10).budget(2).template become<QuadRubber>()};
    Adaptation back{when<QuadRubber>(BeginOfElement{})
                        .above(-10)
                        .budget(1)
                        .stay(3)
                        .template become<QuadLinear>()};
    CentralDifference step;
    there.now(body);
    step(body, 3);
    there.now(body);  // these have the larger values
    REQUIRE(in_rubber(body) == 4);

    back.now(body);

    CHECK(in_rubber(body) == 3);
    back.now(body);
    CHECK(in_rubber(body) == 2);
    back.now(body);
    CHECK(in_rubber(body) == 2);
  });
}

TEST_CASE("elements that an earlier rule takes are left out by later ones", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = linear_square(backend, 4);
    auto const look = when<QuadLinear>(BeginOfElement{});
    Adaptation adapt{look.above(-10).budget(2).template become<QuadRubber>(),
                     look.top_share(0.5).template become<QuadRubber>()};

    adapt.now(body);

    CHECK(in_rubber(body) == 2 + 14 / 2);
  });
}

TEST_CASE("elements that two rules refine count for the first", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = linear_square(backend, 4);
    auto const look = when<QuadLinear>(BeginOfElement{});
    Adaptation adapt{look.above(-10).budget(4).refine(), look.above(-10).budget(4).refine()};

    adapt.now(body);

    CHECK(body.mesh().template elements<Quad4>().size() == 16 + 3 * 8);
  });
}

}  // namespace pliant::test::candidates_suite

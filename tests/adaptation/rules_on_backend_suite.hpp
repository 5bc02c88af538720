#pragma once

#include "adaptation/changes_on_backend.hpp"

// What a rule holds is decided in the backend's memory, of a mesh that is changed there as of one that the host changes.
namespace pliant::test::rules_on_backend_suite {

using two_bodies::count;
using two_bodies::TwoBodies;

/// A bump around a place, beside which all is at rest.
template <class Both>
void bump(Both& both, double place) {
  constexpr std::size_t dim = Both::Body::dim;
  auto u = both.host.mesh().nodes;
  for (auto& p : u) {
    double apart = square(p[0] - place);
    for (std::size_t k = 1; k < dim; ++k) apart += square(p[k] - 0.5);
    p = {};
    p[1] = 0.02 * std::exp(-apart / square(0.2));
  }
  both.body.set_displacements(u);
  both.host.set_displacements(u);
}

/// Looks at both while a bump goes from left to right and back, and checks that they stay the same.
template <class Both, class Rule>
void check_looks(Both& both, Rule const& rule) {
  auto adapt = Adaptation{rule}, other = Adaptation{rule};
  std::vector<Index> counts{count(both.host)};
  for (double const place : {0.2, 0.2, 0.5, 0.8, 0.8, 0.5, 0.2, 0.2}) {
    bump(both, place);
    adapt.now(both.body);
    other.now(both.host);
    REQUIRE(count(both.body) == count(both.host));
    using E = typename Both::Element;
    CHECK(both.body.template groups_of<E>() == both.host.template groups_of<E>());
    CHECK(evaluations_per_step(both.body, rule) == Approx(evaluations_per_step(both.host, rule)));
    counts.push_back(count(both.host));
  }
  both.check_place();
  CHECK(both.body.mesh().tables == both.host.mesh().tables);
  // It refines, and merges.
  CHECK(*std::ranges::max_element(counts) > counts.front());
  CHECK(std::ranges::adjacent_find(counts, std::greater{}) != counts.end());
}

TEST_CASE("a mesh that holds an error or a budget is changed in a backend's memory as by the host",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<class E>(E, Index cells) {
      using F = Formulation<E, Gauss<1>, NeoHookean>;
      using Other = two_bodies::Stiffer<F>;
      auto const at_first = [&](auto const& check_one) {
        TwoBodies<F, B> both(backend, cells, false);
        bump(both, 0.2);
        check_one(both, estimate(both.host, RecoveredStress{}),
                  static_cast<double>(count(both.host)));
      };
      at_first([](auto& both, double error, double) {
        check_looks(both, within<F>(RecoveredStress{}, {.error = error / 4, .max_level = 2}));
      });
      at_first([](auto& both, double, double elements) {
        check_looks(both, within<F>(RecoveredStress{},
                                    {.evaluations_per_step = 3 * elements, .max_level = 2}));
      });
      at_first([](auto& both, double error, double) {
        check_looks(both,
                    within<Other, F>(RecoveredStress{}, {.error = error / 3, .max_level = 2}));
      });
    };
    check(Tri3{}, 8);
    check(Tet4{}, 4);
  });
}

TEST_CASE("what a rule refines is not merged by another one in a backend's memory",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    using Other = two_bodies::Stiffer<F>;
    TwoBodies<F, B> both(backend, 6);
    both.refine_one_in(3);
    auto const change = [](auto& body) {
      Adaptation{when<F>(EdgeLengthRatio{}).above(-1).refine({.max_level = 2}),
                 when<F>(EdgeLengthRatio{}).above(-1).coarsen(),
                 when<Other>(EdgeLengthRatio{}).above(-1).refine({.max_level = 2}),
                 when<Other>(EdgeLengthRatio{}).above(-1).coarsen()}
          .now(body);
    };
    Index const before = count(both.host);
    change(both.body);
    change(both.host);
    both.check_place();
    both.check_all();
    CHECK(count(both.body) == 4 * before);
  });
}

}  // namespace pliant::test::rules_on_backend_suite

#pragma once

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

namespace pliant::test::switching_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <class B>
auto three_group_body(B const& backend, Mesh<Quad4> const& mesh) {
  return Body{backend, mesh, soft, Group<Linear>{}, Group<Turning>{}, Group<Rubber>{}};
}

/// Puts elements into groups at random, and says which.
template <class TheBody>
std::vector<Tag> scatter_groups(TheBody& body, Random& random) {
  std::vector<Index> turning, rubber;
  for (Index e = 0; e < static_cast<Index>(body.mesh().template elements<Quad4>().size()); ++e)
    switch (random.below(3)) {
      case 1:
        turning.push_back(e);
        break;
      case 2:
        rubber.push_back(e);
        break;
      default:
        break;
    }
  body.template assign<Turning>(turning);
  body.template assign<Rubber>(rubber);
  return body.template groups_of<Quad4>();
}

/// The same for every element.
struct Constant {
  double value;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    return typename State::scalar(static_cast<builtin_scalar<typename State::scalar>>(value));
  }
};

TEST_CASE("the elements beyond a threshold switch, and no others", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Quad4>(12);
    Random random(2);
    auto const u = random.field<2>(mesh.nodes.size(), 0.01);
    Adaptation leave{when<Linear>(EdgeLengthRatio{}).above(0.1).become<Turning>()};
    Adaptation come_back{when<Turning>(EdgeLengthRatio{}).below(0.1).become<Linear>()};
    for (bool forth : {true, false}) {
      INFO((forth ? "above" : "below"));
      auto body = three_group_body(backend, mesh);
      body.set_displacements(u);
      auto expected = scatter_groups(body, random);
      auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});
      int moved = 0;
      for (std::size_t e = 0; e < value.size(); ++e) {
        if (forth && expected[e] == 0 && value[e] > static_cast<double>(T(0.1)))
          expected[e] = 1, ++moved;
        else if (!forth && expected[e] == 1 && value[e] < static_cast<double>(T(0.1)))
          expected[e] = 0, ++moved;
      }
      REQUIRE(moved > 3);
      REQUIRE(moved < 40);

      if (forth)
        leave.now(body);
      else
        come_back.now(body);

      CHECK(body.template groups_of<Quad4>() == expected);
    }
  });
}

TEST_CASE("elements between two thresholds stay where they are", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    auto body = three_group_body(backend, mesh);
    Random random(2);
    Adaptation adapt{when<Linear>(EdgeLengthRatio{}).above(0.25).become<Turning>(),
                     when<Turning>(EdgeLengthRatio{}).below(0.125).become<Linear>()};
    std::vector<Tag> model(mesh.elements<Quad4>().size(), 0);
    std::vector<int> switches(model.size(), 0);
    int between = 0;
    for (int k = 0; k < 30; ++k) {
      body.set_displacements(random.field<2>(mesh.nodes.size(), 0.002 * (2 + k % 10)));
      auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});
      for (std::size_t e = 0; e < model.size(); ++e) {
        bool const acts = model[e] == 0 ? value[e] > 0.25 : value[e] < 0.125;
        if (acts) model[e] = 1 - model[e], ++switches[e];
        between += value[e] < 0.25 && value[e] > 0.125 && model[e] == 1;
      }

      adapt.now(body);

      REQUIRE(body.template groups_of<Quad4>() == model);
    }
    CHECK(switch_counts<Quad4>(body) == switches);
    CHECK(between > 20);
  });
}

TEST_CASE("an element stays as long as its rule says", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto body = three_group_body(backend, mesh);
    Random random(2);
    Adaptation adapt{when<Linear>(EdgeLengthRatio{}).above(0.1).stay(5).become<Turning>(),
                     when<Turning>(EdgeLengthRatio{}).below(0.1).stay(3).become<Linear>()};
    std::vector<Tag> model(mesh.elements<Quad4>().size(), 0);
    std::vector<long> since(model.size(), 0);
    int waiting = 0, switched = 0;
    for (int k = 0; k < 40; ++k) {
      take_steps(body.parts(), 1e-9, 1 + static_cast<int>(random.below(2)));
      body.set_displacements(random.field<2>(mesh.nodes.size(), 0.01));
      auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});
      for (std::size_t e = 0; e < model.size(); ++e) {
        bool const wants = model[e] == 0 ? value[e] > 0.1 : value[e] < 0.1;
        bool const may = body.steps() - since[e] >= (model[e] == 0 ? 5 : 3);
        waiting += wants && !may;
        if (wants && may) {
          model[e] = 1 - model[e];
          since[e] = body.steps();
          ++switched;
        }
      }

      adapt.now(body);

      REQUIRE(body.template groups_of<Quad4>() == model);
    }
    CHECK(waiting > 50);
    CHECK(switched > 50);
  });
}

TEST_CASE("the first rule that holds acts, once", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    auto const u = Random(2).field<2>(mesh.nodes.size(), 0.02);
    auto const strict = when<Linear>(EdgeLengthRatio{}).above(0.2).template become<Turning>();
    auto const loose = when<Linear>(EdgeLengthRatio{}).above(0.1).template become<Rubber>();
    auto const onward = when<Turning>(EdgeLengthRatio{}).above(0.0).template become<Rubber>();
    auto const groups_after = [&](auto&& adapt) {
      auto body = three_group_body(backend, mesh);
      body.set_displacements(u);
      adapt.now(body);
      return body.template groups_of<Quad4>();
    };
    auto body = three_group_body(backend, mesh);
    body.set_displacements(u);
    auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});

    auto const strict_first = groups_after(Adaptation{strict, loose, onward});
    auto const loose_first = groups_after(Adaptation{loose, strict, onward});

    int turned = 0, rubbered = 0;
    for (std::size_t e = 0; e < value.size(); ++e) {
      int const by_strict = value[e] > 0.2 ? 1 : value[e] > 0.1 ? 2 : 0;
      CHECK(strict_first[e] == by_strict);
      CHECK(loose_first[e] == (value[e] > 0.1 ? 2 : 0));
      turned += by_strict == 1;
      rubbered += by_strict == 2;
    }
    CHECK(turned > 3);
    CHECK(rubbered > 3);
  });
}

TEST_CASE("ranking rules compare the elements of their own formulation alone", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    Random random(2);
    auto body = three_group_body(backend, mesh);
    body.set_displacements(random.field<2>(mesh.nodes.size(), 0.02));
    auto const expect = [&](auto const& rule, std::size_t count) {
      auto const before = scatter_groups(body, random);
      auto const value = evaluate<Quad4>(body, EdgeLengthRatio{});
      std::vector<std::pair<double, std::size_t>> candidates;
      for (std::size_t e = 0; e < value.size(); ++e)
        if (before[e] == 1) candidates.emplace_back(-value[e], e);
      std::ranges::sort(candidates);
      auto expected = before;
      for (std::size_t k = 0; k < count; ++k) expected[candidates[k].second] = 2;

      Adaptation{rule}.now(body);

      CHECK(body.template groups_of<Quad4>() == expected);
    };
    auto const turning = when<Turning>(EdgeLengthRatio{});

    expect(turning.above(0.0).budget(4).template become<Rubber>(), 4);
    expect(turning.top_share(1).budget(7).template become<Rubber>(), 7);
    expect(turning.above_fraction_of_largest(0.01).budget(1).template become<Rubber>(), 1);
    expect(turning.bulk(1).budget(3).template become<Rubber>(), 3);
    expect(turning.above(0.0).floor(10).template become<Rubber>(), 0);
    expect(turning.top_share(1).floor(10).template become<Rubber>(), 0);
  });
}

TEST_CASE("of equal values, as many elements act as the budget or the share allows",
          "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {8, 8}});
    auto const linear = when<Linear>(Constant{1});
    /// The first elements by the user's number are in group 1.
    auto const first = [&](std::size_t count) {
      std::vector<Tag> groups(mesh.elements<Quad4>().size(), 0);
      std::fill_n(groups.begin(), std::min(count, groups.size()), Tag(1));
      return groups;
    };
    auto const expect = [&](auto&& adapt, auto const& moved_after) {
      auto body = three_group_body(backend, mesh);
      for (int check = 1; check < 16; ++check) {
        adapt.now(body);
        REQUIRE(body.template groups_of<Quad4>() == first(moved_after(check)));
      }
    };
    REQUIRE(mesh.elements<Quad4>().size() == 64);

    expect(Adaptation{linear.above(0.5).budget(5).template become<Turning>()},
           [](int check) { return static_cast<std::size_t>(5 * check); });
    expect(Adaptation{linear.below(1.5).budget(5).template become<Turning>()},
           [](int check) { return static_cast<std::size_t>(5 * check); });
    expect(Adaptation{linear.bulk(1).budget(5).template become<Turning>()},
           [](int check) { return static_cast<std::size_t>(5 * check); });
    expect(Adaptation{linear.above_fraction_of_largest(0.5).budget(5).template become<Turning>()},
           [](int check) { return static_cast<std::size_t>(5 * check); });
    std::size_t moved = 0;
    expect(Adaptation{linear.top_share(0.25).template become<Turning>()},
           [&](int) { return moved += (64 - moved) / 4; });
    expect(Adaptation{linear.bulk(0.25).template become<Turning>()}, [](int) { return 64u; });
  });
}

/// A criterion that is NaN where x of the first node is beyond a limit, x elsewhere.
struct NanBeyond {
  double limit;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    S const x = e.rest(0, 0);
    return select(S(T(limit)) < x, S(std::numeric_limits<T>::quiet_NaN()), x);
  }
};

TEST_CASE("elements where a criterion is NaN do not act and are not counted", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {8, 8}});
    auto const value = [&] {
      auto const body = three_group_body(backend, mesh);
      return evaluate<Quad4>(body, NanBeyond{0.01});
    }();
    auto const present = std::ranges::count_if(value, [](double v) { return v == v; });
    REQUIRE(present > 16);
    REQUIRE(present < 48);
    auto const moved = [&](auto const& rule) {
      auto body = three_group_body(backend, mesh);
      Adaptation{rule}.now(body);
      auto const groups = body.template groups_of<Quad4>();
      for (std::size_t e = 0; e < value.size(); ++e)
        if (value[e] != value[e]) CHECK(groups[e] == 0);
      return std::ranges::count(groups, 1);
    };
    auto const linear = when<Linear>(NanBeyond{0.01});

    CHECK(moved(linear.above(-10).template become<Turning>()) == present);
    CHECK(moved(linear.below(10).template become<Turning>()) == present);
    CHECK(moved(linear.top_share(0.5).template become<Turning>()) == present / 2);
    CHECK(moved(linear.top_share(1).template become<Turning>()) == present);
    CHECK(moved(linear.below(10).budget(7).template become<Turning>()) == 7);
    CHECK(moved(linear.above(-10).budget(present + 1).template become<Turning>()) == present);
  });
}

#if !defined(__CUDACC__)
/// Counts its calls.
struct Counted {
  inline static int calls = 0;
  template <class State>
  auto operator()(State const& e) const {
    ++calls;
    return e.rest(0, 0);
  }
};

TEST_CASE("a check evaluates a criterion once for each element that it looks at", "[adaptation]") {
  auto const mesh = distorted_mesh<Quad4>(6);
  auto const all = static_cast<int>(mesh.elements<Quad4>().size());
  auto const calls_of = [&](auto const&... rules) {
    auto body = three_group_body(Reference<double>{}, mesh);
    body.template assign<Turning>({1, 2, 3});
    Counted::calls = 0;
    Adaptation{rules...}.now(body);
    return Counted::calls;
  };
  auto const linear = when<Linear>(Counted{});
  auto const turning = when<Turning>(Counted{});
  auto const both = when<Linear>(pliant::largest(Counted{}, Constant{-9}));
  auto const same = when<Linear>(pliant::largest(Counted{}, EdgeLengthRatio{}));

  CHECK(calls_of(linear.above(9).become<Turning>()) == all - 3);
  CHECK(calls_of(linear.top_share(0.5).budget(7).become<Turning>()) == all - 3);
  CHECK(calls_of(linear.bulk(0.5).budget(7).become<Turning>(),
                 turning.below(-9).become<Linear>()) == all);
  CHECK(calls_of(linear.above(9).become<Turning>(), linear.top_share(0.5).become<Rubber>()) ==
        all - 3);
  CHECK(calls_of(same.above(9).become<Turning>(), same.top_share(0.5).become<Rubber>()) == all - 3);
  // Criteria with data may differ.
  CHECK(calls_of(both.above(9).become<Turning>(), both.top_share(0.5).become<Rubber>()) ==
        2 * (all - 3));
}

/// 1, and throws from the n-th call on.
struct Throwing {
  int* calls;
  int last;
  template <class State>
  auto operator()(State const&) const {
    if (++*calls >= last) throw Error("a criterion of the user's");
    return typename State::scalar(1);
  }
};

TEST_CASE("a criterion that throws leaves groups and statistics as they were on Reference",
          "[adaptation]") {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {4, 4}});
  int const all = 16;
  for (int last : {1, 7, all, all + 1}) {
    int calls = 0;
    auto const rule = when<Linear>(Throwing{&calls, last});
    auto const check = [&](auto&& adapt) {
      calls = 0;
      auto body = three_group_body(Reference<double>{}, mesh);
      body.set_displacements(Random(2).field<2>(mesh.nodes.size(), 0.01));
      body.template assign<Turning>({3, 5});
      take_steps(body.parts(), 1e-9, 3);
      auto const groups = body.template groups_of<Quad4>();
      auto const steps = element_steps<Quad4>(body);
      bool const throws = last <= all - 2;

      if (throws)
        CHECK_THROWS_WITH(adapt.now(body), says("a criterion of the user's"));
      else
        adapt.now(body);

      CHECK((body.template groups_of<Quad4>() == groups) == throws);
      CHECK(element_steps<Quad4>(body) == steps);
      CHECK(ledger(body).empty() == throws);
      CHECK(switch_counts<Quad4>(body) == [&] {
        std::vector<int> counts(std::size_t{16}, throws ? 0 : 1);
        counts[3] = counts[5] = 0;
        return counts;
      }());
    };
    check(Adaptation{rule.above(0.5).template become<Rubber>()});
    check(Adaptation{rule.above(0.5).budget(100).template become<Rubber>()});
  }
}
#endif

TEST_CASE("adaptation looks at every eighth call, or as often as it is told", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = regular_mesh<Quad4>(3);
    std::vector<Tag> const all(mesh.elements<Quad4>().size(), Tag(1)), none(all.size(), Tag(0));
    auto const rule = when<Linear>(Constant{1}).above(0.5).template become<Turning>();
    auto const back = when<Turning>(Constant{1}).above(0.5).template become<Linear>();
    auto const at_first = [&](auto&& adapt) {
      auto body = three_group_body(backend, mesh);
      CentralDifference step;
      for (int call = 1; call < 20; ++call) {
        step(body);
        adapt(body);
        adapt(body);  // a second look at the same step is none
        if (body.template groups_of<Quad4>() == all) return call;
      }
      return 0;
    };

    CHECK(at_first(Adaptation{rule}) == 8);
    CHECK(at_first(Adaptation{rule}.every(3)) == 3);
    CHECK(at_first(Adaptation{rule}.every(1)) == 1);
    CHECK_THROWS_AS(Adaptation{rule}.every(0), Error);

    auto body = three_group_body(backend, mesh);
    CentralDifference step;
    Adaptation there{rule};
    Adaptation again{back};
    there.every(2);
    step(body);
    there(body);
    there.now(body);
    CHECK(body.template groups_of<Quad4>() == all);
    again.now(body);
    CHECK(body.template groups_of<Quad4>() == none);
    step(body);
    there(body);
    CHECK(body.template groups_of<Quad4>() == all);
  });
}

TEST_CASE("rules that never hold leave the motion alone to the bit", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto const run = [&](auto&& adapt) {
      auto body = three_group_body(backend, mesh);
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -1});
      CentralDifference step;
      for (int k = 0; k < 60; ++k) {
        step(body);
        adapt(body);
      }
      return std::pair{body.displacements(), body.velocities()};
    };
    auto const without = run([](auto&) {});

    auto const check_same = [&](auto const& other) {
      CHECK(difference(other.first, without.first) <= between_runs(1e-13));
      CHECK(difference(other.second, without.second) <= between_runs(1e-12));
    };
    check_same(run(Adaptation<>{}.every(2)));
    check_same(run(Adaptation{when<Linear>(EdgeLengthRatio{}).above(1e9).template become<Turning>(),
                              when<Linear>(AreaRatio{}).top_share(0).template become<Rubber>()}
                       .every(2)));
    CHECK(largest(without.first) > 1e-3);
  });
}

}  // namespace pliant::test::switching_suite

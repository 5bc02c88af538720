#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>
#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// The step follows the groups of elements: it is asked for where they get stiffer, before the next one.
namespace pliant::test::stiffening_suite {

using Gel = Formulation<Quad4, Gauss<2>, Hooke>;
using Stiff = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Softer = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Firm = Formulation<Quad4, Gauss<2>, StableNeoHookean>;
inline constexpr Elastic gel{1e5, 0.3, 1e3}, stiff{16e5, 0.3, 1e3}, softer{5e4, 0.3, 1e3},
    firm{12e5, 0.3, 1e3};

template <class B>
auto resting_body(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  Body body{backend,
            mesh,
            gel,
            Group<Gel>{},
            Group<Stiff>{SaintVenantKirchhoff<double>::from(stiff)},
            Group<Softer>{NeoHookean<double>::from(softer)},
            Group<Firm>{StableNeoHookean<double>::from(firm)}};
  body.clamp(mesh.boundary("left"));
  FieldOf<2> v;
  for (auto const& x : mesh.nodes) v.push_back({0, 1e-3 * square(x[0])});
  body.set_velocities(v);
  return body;
}
/// A region that reaches as far as `reach`, m, along x.
struct Within {
  double reach;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    return select(e.centroid()[0] < S(static_cast<builtin_scalar<S>>(reach)), S(1), S(0));
  }
};
template <class From, class To>
auto rule(double reach) {
  return Adaptation{when<From>(Within{reach}).above(0.5).template become<To>()};
}

TEST_CASE("the step is asked for before the next one where elements go to a stiffer law",
          "[adaptation][solver]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    bool const together = GENERATE(false, true);
    auto body = resting_body(backend);
    CentralDifference step{{.watch_interval = 1 << 20}};
    step(body, 20);
    double const before = step.step();
    auto to_stiff = rule<Gel, Stiff>(0.3).every(4);

    if (together) {
      step(body, 3, to_stiff);
      CHECK(step.step() == before);
      step(body, 2, to_stiff);
    } else {
      to_stiff.now(body);
      step(body);
    }

    CHECK(step.step() == Approx(0.25 * before).epsilon(0.2));
    CHECK(step.step() <= 0.9001 * stable_step(body));
    step(body, 2000);
    CHECK(step.retries() == 0);
    CHECK(largest(body.displacements()) < 0.01);
  });
}

TEST_CASE("the step is not asked for where nothing gets stiffer than it allows",
          "[adaptation][solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = resting_body(backend);
    CentralDifference step{{.watch_interval = 1 << 20}};
    step(body, 20);
    auto const asked = [&] { return body.state().integrator.next_refresh <= body.steps(); };
    rule<Gel, Softer>(-1).now(body);  // nothing moves
    CHECK_FALSE(asked());
    rule<Gel, Softer>(0.5).now(body);
    CHECK(body.template groups_of<Quad4>()[0] == 2);
    CHECK_FALSE(asked());
    rule<Softer, Gel>(0.5).now(body);  // back to what the step was chosen for
    CHECK_FALSE(asked());
    rule<Gel, Stiff>(0.2).now(body);
    CHECK(asked());
    step(body);
    CHECK_FALSE(asked());
    rule<Gel, Stiff>(0.5).now(body);  // no stiffer than those that are stiff already
    CHECK_FALSE(asked());
    double const short_step = step.step();

    // The longer step comes back with the next evaluation.
    rule<Stiff, Gel>(2).now(body);
    step(body, 1024);
    CHECK(step.step() > 3 * short_step);

    CentralDifference given{{.step = 0.2 * short_step}};
    given(body, 20);
    rule<Gel, Stiff>(0.5).now(body);
    CHECK_FALSE(asked());
  });
}

TEST_CASE("a stiff element that gets less stiff asks for no step", "[adaptation][solver]") {
  MainBackend const backend;
  auto body = resting_body(backend);
  body.template assign<Stiff>({4});  // alone: its nodes move with what is around it
  CentralDifference step{{.watch_interval = 1 << 20}};
  step(body, 20);
  auto const firmly = stable_step(body);
  body.template assign<Gel>({4});
  REQUIRE(stable_step(body) > 1.2 * firmly);
  body.template assign<Stiff>({4});
  step(body, 20);
  rule<Stiff, Firm>(2).now(body);
  CHECK(body.state().integrator.next_refresh > body.steps());
}

/// Waits for no answer, as a GPU does: the host does not know of moves.
struct Unasked : Reference<double> {
  static constexpr char const* name() { return "Unasked"; }
  struct Recording : HostRecording {
    using HostRecording::HostRecording;
    Recording(HostRecording other) : HostRecording(std::move(other)) {}
  };
  Recording record(std::function<void()> f) const { return HostRecording(std::move(f)); }
};

TEST_CASE("the host asks for moves to stiffer laws, and for no others", "[adaptation][solver]") {
  auto body = resting_body(Unasked{});
  CentralDifference step;
  step(body, 20);
  double const before = step.step();
  auto to_stiff = rule<Gel, Stiff>(0.3).every(4);
  step(body, 5, to_stiff);
  CHECK(step.step() == Approx(0.25 * before).epsilon(0.2));
  step(body, 2000, to_stiff);
  CHECK(step.retries() == 0);
  CHECK_FALSE(body.parts().recorded_with_look);  // a GPU would not wait in it

  // Where it does not know, the step follows with the distortion.
  auto other = resting_body(Unasked{});
  CentralDifference watching{{.check_interval = 1 << 20, .watch_interval = 16}};
  watching(other, 20);
  auto to_softer = rule<Stiff, Gel>(2).every(4);
  other.template assign<Stiff>({4});
  watching(other, 28, to_softer);
  CHECK(other.parts().recorded_with_look);
  auto& work = other.parts().state.work;
  CHECK(is_stiffened(other.parts()) == false);
  other.parts().backend.for_each(
      1, detail::AddValue{work.data() + static_cast<int>(Work::stiffened), 1.0});
  REQUIRE(other.state().integrator.next_refresh > other.steps() + 20);
  watching(other, 17);
  CHECK(other.state().integrator.next_refresh >= other.steps() + 1024 - 17);
  CHECK_FALSE(is_stiffened(other.parts()));
}

TEST_CASE("a run that is saved behind a switch asks for its step all the same",
          "[adaptation][solver][state]") {
  using Backends = decltype(std::tuple_cat(MainAlone{}, std::tuple<Unasked>{}));
  on_each_backend<Backends>([]<class B>(B const& backend) {
    bool const local = GENERATE(false, true);
    auto whole = resting_body(backend), part = resting_body(backend), next = resting_body(backend);
    auto const advance = [&](auto& body, CentralDifference& step, LocalSteps& by_element, int n) {
      if (local)
        by_element(body, n);
      else
        step(body, n);
    };
    CentralDifference steps[3];
    LocalSteps locals[3];
    advance(whole, steps[0], locals[0], 20);
    advance(part, steps[1], locals[1], 20);
    rule<Gel, Stiff>(0.3).now(whole);
    rule<Gel, Stiff>(0.3).now(part);
    std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
    part.save(file);
    next.load(file);
    CHECK(first_difference(whole.state(), next.state()) == "");

    advance(whole, steps[0], locals[0], 50);
    advance(next, steps[2], locals[2], 50);

    CHECK(difference(whole.displacements(), next.displacements()) <= between_runs(1e-9));
    CHECK(whole.time() == Approx(next.time()).epsilon(between_runs(1e-6)));
    if (between_runs(1) == 0) CHECK(first_difference(whole.state(), next.state()) == "");
  });
}

}  // namespace pliant::test::stiffening_suite

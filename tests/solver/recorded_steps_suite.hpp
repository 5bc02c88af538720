#pragma once

#include <memory>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// Many steps at once are recorded and replayed; they are the same steps.
namespace pliant::test::recorded_steps_suite {

template <class F, class B>
auto swinging_body(B const& backend, Mesh<Quad4> const& mesh) {
  auto body = body_of<F>(backend, mesh);
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0.1, -0.3});
  body.set_damping(0.5);
  body.set_load(7, {0.01, 0.02});
  body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
  return body;
}

template <class TheBody>
void check_same(TheBody& a, TheBody& b) {
  double const rounding =
      between_runs(256 * double{std::numeric_limits<typename TheBody::scalar>::epsilon()});
  CHECK(difference(a.displacements(), b.displacements()) <= rounding);
  CHECK(difference(a.velocities(), b.velocities()) <= 16 * rounding);
  CHECK(a.steps() == b.steps());
  CHECK(a.time() == Approx(b.time()).epsilon(1e-13));
}

TEST_CASE("a hundred steps are a hundred times one step, to the bit", "[solver]") {
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto at_once = swinging_body<Rubber>(backend, mesh);
    auto one_by_one = swinging_body<Rubber>(backend, mesh);
    auto looked_at = swinging_body<Rubber>(backend, mesh);
    CentralDifferenceOptions const options{.check_interval = 40, .refresh_interval = 64};
    CentralDifference step{options}, other_step{options}, third_step{options};

    step(at_once, 100);
    for (int k = 0; k < 100; ++k) other_step(one_by_one);
    for (int k = 0; k < 100; ++k) {
      third_step(looked_at);
      if (k % 7 == 0) (void)looked_at.velocities();
    }

    check_same(at_once, one_by_one);
    check_same(at_once, looked_at);
    CHECK(largest(at_once.displacements()) > 0.01);
    CHECK(at_once.steps() == 100);
  });
}

TEST_CASE("a body with driven nodes takes the same steps at once", "[solver]") {
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto const pull = [](double t) -> Point<2> { return {0.1 * t, -0.2 * t * t}; };
    auto at_once = swinging_body<Rubber>(backend, mesh);
    auto one_by_one = swinging_body<Rubber>(backend, mesh);
    at_once.drive(mesh.boundary("right"), pull);
    one_by_one.drive(mesh.boundary("right"), pull);
    CentralDifference step{{.step = 1e-3}}, other_step{{.step = 1e-3}};

    step(at_once, 50);
    for (int k = 0; k < 50; ++k) other_step(one_by_one);

    check_same(at_once, one_by_one);
    Index const right = mesh.boundary("right")[0][0];
    CHECK(at_once.displacements()[static_cast<std::size_t>(right)][0] == Approx(0.005));
  });
}

TEST_CASE("a body that moved to another place steps on", "[solver]") {
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    auto stays = swinging_body<Rubber>(backend, mesh);
    auto first = std::make_unique<decltype(stays)>(swinging_body<Rubber>(backend, mesh));
    CentralDifference step{{.step = 1e-3}}, other_step{{.step = 1e-3}};
    step(stays, 90);

    other_step(*first, 30);
    auto second = std::make_unique<decltype(stays)>(std::move(*first));
    first.reset();
    other_step(*second, 30);
    *second = decltype(stays)(std::move(*second));
    other_step(*second, 30);

    check_same(stays, *second);
  });
}

TEST_CASE("bodies are moved, on no backend copied", "[solver]") {
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using TheBody = decltype(swinging_body<Rubber>(backend, distorted_mesh<Quad4>(6)));
    CHECK(std::movable<TheBody>);
    // A copy's laws would look at the values per element of the body that it was copied from.
    CHECK_FALSE(std::copy_constructible<TheBody>);
    CHECK_FALSE(std::is_copy_assignable_v<TheBody>);
  });
}

}  // namespace pliant::test::recorded_steps_suite

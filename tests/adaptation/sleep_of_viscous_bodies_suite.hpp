#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>

#include "adaptation/criteria.hpp"
#include "support/repeatable.hpp"
#include "support/small_patches.hpp"

// Patches whose points relax are awake until that moves nothing; what is left of it goes on while they sleep.
namespace pliant::test::sleep_of_viscous_bodies_suite {

template <class T>
using Maxwell = Prony<SaintVenantKirchhoff>::law<T>;
using Relaxing = Formulation<Tri3, Gauss<1>, Maxwell>;
template <class T>
using Voigt = KelvinVoigt<SaintVenantKirchhoff>::law<T>;
using Damped = Formulation<Tri3, Gauss<1>, Voigt>;

inline SaintVenantKirchhoff<double> elastic(double poisson = soft.poisson) {
  return SaintVenantKirchhoff<double>::from(
      Elastic{.young = soft.young, .poisson = poisson, .density = soft.density});
}
inline Group<Relaxing> relaxing(double time) { return {{{elastic(), {1}, {time}}}}; }
/// Without a pull across: stretched alike everywhere, elements pull at their neighbours and at the ends alone.
inline Group<Relaxing> relaxing_along(double time) { return {{{elastic(0), {1}, {time}}}}; }
inline Group<Damped> damped() { return {{{elastic(), 20}}}; }

/// A long bar of several patches on every backend.
template <class B, class F>
auto bar(B const& backend, Group<F> const& group) {
  int const rows = B::orders_by_group ? 6 : 3;
  auto const mesh = mesh::rectangle<Tri3>({.size = {20, 0.05 * rows}, .cells = {400, rows}});
  return Body{backend, mesh, soft, group};
}
/// So that every strain is the same and stays so: points relax, and nothing moves.
template <class TheBody>
void stretch(TheBody& body) {
  auto u = body.mesh().nodes;
  for (auto& p : u) p = {0.01 * p[0], 0};
  body.set_displacements(u);
  for (char const* end : {"left", "right"}) body.clamp(body.mesh().boundary(end));
  for (char const* edge : {"bottom", "top"}) body.hold(body.mesh().boundary(edge), 2);
}
template <class TheBody>
void hit(TheBody& body) {
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i)
    if (body.mesh().nodes[i][0] < 0.3) v[i] = {0.05, 0.02};
  body.set_velocities(v);
}
template <class TheBody>
auto internal_variables(TheBody const& body) {
  return download<typename TheBody::scalar>(
      std::get<0>(body.parts().state.elements).internal_variables);
}
template <class Values>
double furthest(Values const& a, Values const& b) {
  double apart = 0, most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    apart = std::max(apart, std::abs(static_cast<double>(a[k] - b[k])));
    most = std::max(most, std::abs(static_cast<double>(b[k])));
  }
  return apart / most;
}

TEST_CASE(
    "patches are awake while their points relax, even where neighbours cancel and nothing moves",
    "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    CentralDifference step;
    auto probe = bar(backend, relaxing_along(1));
    stretch(probe);
    step(probe);
    double const time = 40 * step.step();
    auto body = bar(backend, relaxing_along(time));
    body.set_displacements(body.displacements());
    stretch(body);
    auto adapt = Adaptation{sleep({.below = 1e-4, .for_steps = 8})}.every(8);
    step(body, 64, adapt);
    CHECK(asleep(body).patches == 0);
    step(body, 1200, adapt);
    CHECK(asleep(body).patches == asleep(body).of_patches);
  });
}

TEST_CASE("points relax by the time that they slept", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    CentralDifference step, other;
    auto probe = bar(backend, relaxing(1));
    stretch(probe);
    step(probe);
    double const time = 100 * step.step();
    auto body = bar(backend, relaxing(time)), awake = bar(backend, relaxing(time));
    for (auto* b : {&body, &awake}) stretch(*b);
    // So loose that it sleeps long before it has relaxed.
    auto adapt = Adaptation{sleep({.below = 1e3, .for_steps = 8})}.every(8);
    step(body, 120, adapt);
    other(awake, 120);
    REQUIRE(asleep(body).patches == asleep(body).of_patches);
    CHECK(furthest(internal_variables(body), internal_variables(awake)) > 0.1);
    std::stringstream stream;
    body.save(stream);
    auto again = bar(backend, relaxing(time));
    again.load(stream);
    for (auto* b : {&body, &again}) {
      let_sleep(b->parts());
      wake_all(b->parts());
    }
    CHECK(first_difference(body.state(), again.state()) == "");
    double const rounding =
        sizeof(typename B::scalar) == 8 ? 1e-10 : 5e-3;  // noise of float moves the awake one
    CHECK(furthest(internal_variables(body), internal_variables(awake)) < rounding);
    CHECK(difference(body.forces(), awake.forces()) < rounding * largest(awake.forces()));
  });
}

TEST_CASE("a viscous body that sleeps where it rests moves as one that is awake", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const moves_alike = [&](auto const& group) {
      auto body = bar(backend, group), awake = bar(backend, group);
      for (auto* b : {&body, &awake}) hit(*b);
      CentralDifference step, other;
      auto adapt = Adaptation{sleep({.below = 1e-6, .for_steps = 16})}.every(4);
      step(body, 40, adapt);
      other(awake, 40);
      REQUIRE(asleep(body).patches > 0);
      REQUIRE(asleep(body).patches < asleep(body).of_patches);
      step(body, 200, adapt);
      other(awake, 200);
      double const allowed = 1e-2;
      CHECK(difference(body.displacements(), awake.displacements()) <
            allowed * largest(awake.displacements()));
      wake_all(body.parts());
      CHECK(furthest(internal_variables(body), internal_variables(awake)) < allowed);
    };
    moves_alike(relaxing(0.05));
    moves_alike(damped());
  });
}

}  // namespace pliant::test::sleep_of_viscous_bodies_suite

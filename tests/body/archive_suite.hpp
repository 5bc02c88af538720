#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>

#include "support/formulations.hpp"

namespace pliant::test {

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
template <class TheBody, class... Rest>
Run(TheBody, Rest...) -> Run<TheBody, Rest...>;

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

}  // namespace pliant::test

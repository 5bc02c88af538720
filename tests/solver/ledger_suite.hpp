#pragma once

#include "support/formulations.hpp"

// What leapfrog keeps changes by what is booked, and by nothing else.
namespace pliant::test::ledger_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};

/// Steps a swinging body under what `begin` does first and `each` before every second step, and returns the
/// largest change of what leapfrog keeps less what is booked, over the largest energy.
template <class F, class B, class Begin, class Each>
double unbooked(B const& backend, double fraction, Begin const& begin, Each const& each) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  auto body = body_of<F>(backend, mesh, gel);
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -1});
  begin(body);
  CentralDifference step{{.step = fraction * stable_step(body)}};
  step(body);
  auto const remainder = [&] {
    return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
  };
  double const first = remainder();
  double error = 0, largest = 0;
  for (int k = 0; k < 150; ++k) {
    each(body, k);
    step(body, 2);
    error = std::max(error, std::abs(remainder() - first));
    largest = std::max(largest, strain_energy(body) + kinetic_energy(body));
  }
  CHECK(step.retries() == 0);
  CHECK(largest > 1e-3);
  return error / largest;
}

constexpr auto nothing = [](auto&) {};
constexpr auto nothing_each = [](auto&, int) {};

/// Linear laws, to rounding, at both fractions; nonlinear ones at 0.3 of the stable step.
template <class B, class Begin, class Each>
void check_ledger(B const& backend, Begin const& begin, Each const& each, double finer = 1) {
  CHECK(unbooked<Linear>(backend, 0.9 / finer, begin, each) < 1e-12);
  CHECK(unbooked<Linear>(backend, 0.3 / finer, begin, each) < 1e-12);
  CHECK(unbooked<Rubber>(backend, 0.3 / finer, begin, each) < 1e-3);
}

TEST_CASE("gravity and damping are booked", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_ledger(backend, nothing, nothing_each);
    for (double rate : {0.1, 10.0, 1000.0}) {
      CAPTURE(rate);
      check_ledger(
          backend, [=](auto& body) { body.set_damping(rate); }, nothing_each);
    }
  });
}

TEST_CASE("the work of driven nodes is booked", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const of_time = [](double t) -> Point<2> { return {0.02 * std::sin(9 * t), 0.1 * t * t}; };
    auto const of_place = [](Point<2> const& x, double t) -> Point<2> {
      return {0.1 * x[1] * std::sin(7 * t), 0.03 * t};
    };
    auto const drive = [](auto motion, DirectionMask directions) {
      return [=](auto& body) {
        body.drive(body.mesh().boundary("right"), motion, {.directions = directions});
      };
    };
    check_ledger(backend, drive(of_time, 3), nothing_each);
    check_ledger(backend, drive(of_time, 2), nothing_each);
    check_ledger(backend, drive(of_place, 3), nothing_each);
  });
}

TEST_CASE("the work of a pressure that follows its surface is booked", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_ledger(
        backend, [](auto& body) { body.press(body.mesh().boundary("top"), 300); }, nothing_each);
  });
}

TEST_CASE("the work of loads that are set between steps is booked", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_ledger(backend, nothing, [](auto& body, int) {
      body.set_load(20, {3 * std::sin(11 * body.time()), 5 * body.time()});
    });
    check_ledger(backend, nothing, [](auto& body, int k) {
      if (k % 20 == 10) body.set_gravity({0.1 * k, -1});
    });
    check_ledger(backend, nothing, [](auto& body, int k) {
      if (k % 20 == 10)
        body.set_loads(FieldOf<2>(static_cast<std::size_t>(body.nodes()), {0.01 * k, -0.2}));
    });
  });
}

TEST_CASE("what a user changes of the state is booked", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("velocities") {
      check_ledger(backend, nothing, [](auto& body, int k) {
        if (k % 30 != 10) return;
        auto v = body.velocities();
        for (auto& x : v) x[0] += 0.1;
        body.set_velocities(v);
      });
    }
    SECTION("holding and releasing") {
      Handle handle;
      check_ledger(backend, nothing, [&](auto& body, int k) {
        if (k % 40 == 10) handle = body.hold(body.mesh().boundary("right"), 2);
        if (k % 40 == 30) body.release(handle);
      });
    }
    SECTION("refining") {
      check_ledger(
          backend, nothing,
          [](auto& body, int k) {
            if (k % 50 == 10) refine(body, {{static_cast<Index>(k / 10), 9}}, 1);
          },
          2);
    }
    SECTION("groups") {
      using Stiff = Formulation<Quad4, Gauss<3>, Hooke>;
      auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
      Body body{backend, mesh, gel, Group<Linear>{},
                Group<Stiff>{{Hooke<double>::from({2e5, 0.2, 1e3})}}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -1});
      CentralDifference step{{.step = 0.5 * stable_step(body)}};
      step(body);
      auto const remainder = [&] {
        return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
      };
      double const first = remainder();
      double largest = 0;
      for (int k = 0; k < 10; ++k) {
        step(body, 20);
        if (k % 2 == 0)
          body.template assign<Stiff>({k, 9});
        else
          body.template assign<Linear>({9, 3});
        largest = std::max(largest, strain_energy(body) + kinetic_energy(body));
        CHECK(std::abs(remainder() - first) < 1e-12 * largest);
      }
      CHECK(std::abs(external_work(body).by_hand) > 1e-6 * largest);
    }
  });
}

}  // namespace pliant::test::ledger_suite

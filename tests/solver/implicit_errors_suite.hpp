#pragma once

#include <sstream>

#include <pliant/solver/implicit.hpp>
#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/repeatable.hpp"

// What implicit steps tell of how far they are off, beside short steps.
namespace pliant::test::implicit_errors_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

/// A column in balance under twice the weight that buckles it, which begins to lean to a side.
template <class B>
auto column(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {10, 1}});
  Body body{backend, mesh, Elastic{1e6, 0.3, 1000}, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({-16, 0});
  solve_static(body);
  body.set_gravity({-16, 1e-2});
  return body;
}
template <class TheBody, class Scheme>
ImplicitReport fall(TheBody& body, Scheme const& scheme, double step,
                    ErrorEstimate errors = ErrorEstimate::carried) {
  return Implicit{scheme, {.step = step, .errors = errors}}.until(body, 2);
}

TEST_CASE("carried errors bound how far a body that buckles is off, their sum does not",
          "[solver]") {
  auto short_steps = column(MainBackend{});
  fall(short_steps, Newmark{}, 5e-3, ErrorEstimate::added_up);
  auto const exact = short_steps.displacements();
  CHECK(largest(exact) > 0.2);
  auto const check = [&](auto const& scheme, double step) {
    CAPTURE(scheme.name);
    auto body = column(MainBackend{}), other = column(MainBackend{});
    auto const carried = fall(body, scheme, step),
               summed = fall(other, scheme, step, ErrorEstimate::added_up);
    CHECK(difference(body.displacements(), other.displacements()) == 0);
    double const off = difference(body.displacements(), exact);
    CHECK(carried.errors == ErrorEstimate::carried);
    CHECK(carried.error_in_all > off);
    CHECK(carried.error_in_all < 5 * off);
    CHECK(summed.errors == ErrorEstimate::added_up);
    CHECK(summed.error_in_all < 0.8 * off);
  };
  check(BackwardEuler{}, 2e-2);
  check(Newmark{}, 5e-2);
  check(GeneralizedAlpha{0.8}, 5e-2);
  check(BDF2{}, 5e-2);
}

TEST_CASE("carried errors of a body that buckles are the same with a matrix and without",
          "[solver]") {
  auto const carried = [](LinearMethod method) {
    auto body = column(MainBackend{});
    ImplicitOptions options{.step = 5e-2, .errors = ErrorEstimate::carried};
    options.linear = method;
    return Implicit{Newmark{}, options}.until(body, 2).error_in_all;
  };
  CHECK(carried(LinearMethod::matrix_free) == Approx(carried(LinearMethod::direct)).epsilon(0.02));
}

TEST_CASE("errors that have come to a tenth of displacements are told as lost", "[solver]") {
  auto rough = column(MainBackend{}), fine = column(MainBackend{});
  CHECK(fall(rough, BackwardEuler{}, 5e-2).errors_lost);
  CHECK_FALSE(fall(fine, Newmark{}, 5e-2).errors_lost);
}

TEST_CASE("steps that follow their error carry it unasked", "[solver]") {
  auto body = column(MainBackend{});
  Implicit step{Newmark{}, {.step = 1e-2, .error = 1e-5}};
  CHECK(step(body).errors == ErrorEstimate::carried);
  auto other = column(MainBackend{});
  CHECK(Implicit{Newmark{}, {.step = 1e-2}}(other).errors == ErrorEstimate::added_up);
}

TEST_CASE("errors are carried the same way with a matrix and without", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    bool const in_double = sizeof(typename B::scalar) == 8;
    auto const carried = [&](LinearMethod method) {
      auto body = column(backend);
      refine(body, {{3, 4}});
      body.set_damping(0.1);
      ImplicitOptions options{.step = 5e-2,
                              .stiffness_damping = 1e-4,
                              .errors = ErrorEstimate::carried,
                              .tolerance = in_double ? 1e-11 : 1e-4};
      options.linear = method;
      return Implicit{BDF2{}, options}(body, 20).error_in_all;
    };
    double const with = carried(LinearMethod::direct);
    CHECK(with > 1e-4);
    CHECK(carried(LinearMethod::matrix_free) == Approx(with).epsilon(in_double ? 0.05 : 0.2));
  });
}

TEST_CASE("carried errors go on over calls, and from a saved state", "[solver][state]") {
  auto whole = column(MainBackend{}), parted = column(MainBackend{}),
       loaded = column(MainBackend{});
  ImplicitOptions const options{.step = 1e-2, .errors = ErrorEstimate::carried};
  Implicit step{Newmark{}, options};
  double const in_one = step(whole, 20).error_in_all;
  for (int k = 0; k < 4; ++k) step(parted, 4);
  std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
  parted.save(file);
  loaded.load(file);
  CHECK(step(parted, 4).error_in_all == Approx(in_one).epsilon(between_runs(1e-6) + 1e-12));
  CHECK(Implicit{Newmark{}, options}(loaded, 4).error_in_all ==
        Approx(in_one).epsilon(between_runs(1e-6) + 1e-12));
}

}  // namespace pliant::test::implicit_errors_suite

#pragma once

#include "adaptation/changes_on_backend.hpp"

// Bodies of quadratic elements whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::quadratic_on_backend_suite {
using namespace two_bodies;

template <class E>
using Soft = Formulation<E, Gauss<std::same_as<E, Tet10> ? 2 : 3>, NeoHookean>;

TEST_CASE("quadratic elements that a body's backend refines are those that the host would make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_rounds<Soft<Quad8>>(backend, 4, 6, 3);
    check_rounds<Soft<Hex20>>(backend, 2, 8, 2);
  });
}

TEST_CASE("quadratic elements that a body's backend merges are those that the host would make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_both_ways<Soft<Tri6>>(backend, 5, 5, 2);
    check_both_ways<Soft<Quad9>>(backend, 5, 5, 2);
    check_both_ways<Soft<Tet10>>(backend, 2, 5, 1);
    check_both_ways<Soft<Hex27>>(backend, 3, 8, 1);
  });
}

TEST_CASE("a mesh of quadratic elements that is brought over is the one that the host would make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_brought_over<Soft<Tri6>>(backend, 5, 5, 3);
    check_brought_over<Soft<Quad8>>(backend, 5, 5, 3);
    check_brought_over<Soft<Tet10>>(backend, 2, 5, 3);
    check_brought_over<Soft<Hex27>>(backend, 3, 8, 2);
  });
}

TEST_CASE("pressures and motions act on sides of quadratic elements that a body's backend changes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const act = [](auto& body) {
      constexpr int dim = std::remove_cvref_t<decltype(body)>::dim;
      auto const& mesh = body.mesh();
      body.press(mesh.boundary("right"), 0.4);
      body.press(mesh.boundary("top"), -0.25);
      body.drive(mesh.boundary("left"), turned<dim>);
      body.drive(mesh.boundary("right"), drawn<dim>, {.directions = 1});
    };
    check_changes<Soft<Tri6>>(backend, 5, 5, act);
    check_changes<Soft<Quad9>>(backend, 5, 5, act);
    check_changes<Soft<Tet10>>(backend, 2, 5, act);
    check_changes<Soft<Hex20>>(backend, 3, 8, act);
    check_changes<Soft<Hex27>>(backend, 3, 8, act);
  });
}

}  // namespace pliant::test::quadratic_on_backend_suite

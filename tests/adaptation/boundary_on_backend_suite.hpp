#pragma once

#include <limits>
#include <string>

#include "adaptation/changes_on_backend.hpp"

// Pressures and driven nodes of bodies whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::boundary_on_backend_suite {
using namespace two_bodies;

template <class E>
using Soft = Formulation<E, Gauss<SimplexCell<typename E::cell> ? 1 : 2>, NeoHookean>;

template <class B, class SetUp>
void check_all_elements(B const& backend, SetUp const& set_up) {
  check_changes<Soft<Tri3>>(backend, 6, 5, set_up);
  check_changes<Soft<Quad4>>(backend, 6, 5, set_up);
  check_changes<Soft<Tet4>>(backend, 3, 12, set_up);
  check_changes<Soft<Hex8>>(backend, 3, 8, set_up);
  check_changes<Soft<Wedge6>>(backend, 3, 10, set_up);
}

TEST_CASE("pressures act on the facets that a body's backend divides and merges", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const press = [](auto& body) {
      auto const& mesh = body.mesh();
      body.press(mesh.boundary("right"), 0.4);
      body.press(mesh.boundary("top"), -0.25);
      body.press(mesh.boundary("bottom"), 0);
      body.hold(mesh.boundary("top"), 1);  // the same facets
    };
    check_all_elements(backend, press);
  });
}

TEST_CASE("motions drive the nodes of facets that a body's backend divides and merges",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const drive = [](auto& body) {
      constexpr int dim = std::remove_cvref_t<decltype(body)>::dim;
      auto const& mesh = body.mesh();
      body.drive(mesh.boundary("right"), drawn<dim>, {.directions = 1});
      body.drive(mesh.boundary("left"), turned<dim>);
      body.drive(std::vector<Index>{body.nodes() / 2}, drawn<dim>, {.directions = 2});
    };
    check_all_elements(backend, drive);
  });
}

TEST_CASE("what is prescribed between changes of a body's backend acts behind them",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Soft<Tri3>, B> both(backend, 6, false);
    Handle driven, pressed;
    auto const in_both = [&](auto const& change) {
      change(both.body);
      change(both.host);
    };
    both.refine_one_in(4);
    in_both([&](auto& body) { pressed = body.press(body.mesh().boundary("right"), 30); });
    both.refine_one_in(4);
    both.check_all();
    in_both([&](auto& body) { driven = body.drive(body.mesh().boundary("top"), drawn<2>); });
    both.coarsen_all_but_one_in(9);
    both.check_all();
    in_both([&](auto& body) { body.press(body.mesh().boundary("right"), -10); });
    both.check_all();
    both.refine_one_in(4);
    both.check_all();
    CHECK(both.body.parts().driven.size() == 1);
    in_both([&](auto& body) {
      body.release(driven);
      body.release(pressed);
    });
    both.refine_one_in(4);
    both.check_all();
    CHECK(both.body.parts().driven.empty());
    CHECK(both.body.parts().pressures.empty());
  });
}

TEST_CASE("where a part of what would be merged is pressed, the rest is merged", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Soft<Quad4>, B> both(backend, 4, false);
    auto const all_of = [](auto const& body) {
      std::vector<Index> all;
      for (Index e = 0; e < count(body); ++e) all.push_back(e);
      return all;
    };
    auto const change = [&](auto& body) {
      refine(body, {all_of(body)});
      body.press({body.mesh().boundary("right")[0]}, 20);
      return coarsen(body, {all_of(body)}).merged;
    };
    auto const merged = change(both.body);
    CHECK(merged == change(both.host));
    CHECK(merged > 10);
    both.check_place();
    both.check_all();
  });
}

TEST_CASE("a motion that is not finite behind a change of a body's backend tells the node",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Soft<Quad4>, B> both(backend, 4, false);
    double worst = 0;  // so that one of the nodes that refinement made is named
    auto const nowhere = [&](Point<2> const& x, double time) {
      return Point<2>{x[1] == worst ? time / (time < 1e-3 ? 1 : 0) : time, 0};
    };
    auto const message_of = [&](auto& body) {
      body.drive(body.mesh().boundary("right"), nowhere, {.directions = 1});
      auto const nodes = body.nodes();
      std::vector<Index> all;
      for (Index e = 0; e < count(body); ++e) all.push_back(e);
      refine(body, {all});
      for (Index node : nodes_of(body.mesh().boundary("right")))
        if (node >= nodes) worst = body.mesh().nodes[at(node)][1];
      try {
        CentralDifference steps({.step = 1e-3});
        steps(body, 5);
      } catch (Error const& e) {
        return std::string(e.what());
      }
      return std::string();
    };
    auto const message = message_of(both.body);
    CHECK(is_on_backend(both.body));
    CHECK(message.find("not finite") + message.find("must be finite") != 2 * std::string::npos);
    CHECK(message == message_of(both.host));
  });
}

}  // namespace pliant::test::boundary_on_backend_suite

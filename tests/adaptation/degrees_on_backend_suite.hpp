#pragma once

#include <sstream>

#include "adaptation/both_types.hpp"

// Bodies of linear and quadratic elements whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::degrees_on_backend_suite {
using namespace two_bodies;

/// Raises one in two elements of the first type, and gives the other body the same.
template <Element A, Element C, class B>
void raise_some(BothTypes<A, C, B>& both) {
  auto marked = random_marks(both.host, both.random, 2);
  marked[1].clear();
  REQUIRE(raise(both.host, marked).raised > 4);
  std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
  both.host.save(saved);
  both.body.load(saved);  // which its backend may change
  REQUIRE(!both.host.mesh().slaves.empty());
}

template <Element A, Element C, class B>
void check_degrees(B const& backend, Mesh<A, C> const& mesh, std::size_t one_in) {
  BothTypes<A, C, B> both(backend, mesh);
  raise_some(both);
  both.check_all();
  std::size_t merged = 0;
  for (int round = 0; round < 3; ++round) {
    both.refine_one_in(one_in);
    both.check_all();
    both.refine_one_in(one_in);
    merged += both.coarsen_all_but_one_in(12);
    both.check_all();
  }
  CHECK(merged > 4);
}

TEST_CASE("elements of two degrees that a body's backend changes are those that the host makes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_degrees(backend, mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)), 6);
    check_degrees(backend, mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)), 6);
    check_degrees(backend, mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)), 8);
    check_degrees(backend, mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex8>(3)), 8);
  });
}

/// Raises some elements of both bodies, or lowers some.
template <Element A, Element C, class B>
void convert_both(BothTypes<A, C, B>& both, bool raises, std::size_t one_in, int ring = 0) {
  auto marked = random_marks(both.host, both.random, one_in);
  marked[raises ? 1 : 0].clear();
  if (raises) {
    auto const done = raise(both.body, marked, {.ring = ring}),
               wanted = raise(both.host, marked, {.ring = ring});
    CHECK(wanted.raised > 0);
    CHECK(done.raised == wanted.raised);
    CHECK(done.new_nodes == wanted.new_nodes);
  } else {
    auto const done = lower(both.body, marked), wanted = lower(both.host, marked);
    CHECK(wanted.lowered > 0);
    CHECK(done.lowered == wanted.lowered);
    CHECK(done.gone_nodes == wanted.gone_nodes);
  }
  both.check_place();
}

template <Element A, Element C, class B>
void check_conversions(B const& backend, Mesh<A, C> const& mesh, std::size_t one_in) {
  BothTypes<A, C, B> both(backend, mesh);
  for (int round = 0; round < 2; ++round) {
    convert_both(both, true, 2);
    both.check_all();
    both.refine_one_in(one_in);
    convert_both(both, false, 3);
    both.check_all();
    convert_both(both, true, one_in, 1);
    both.coarsen_all_but_one_in(12);
    both.check_all();
  }
}

TEST_CASE("elements that a body's backend raises and lowers are those that the host makes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_conversions(backend, mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)), 6);
    check_conversions(backend, mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)), 6);
    check_conversions(backend, mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)), 8);
    check_conversions(backend, mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex8>(3)), 8);
  });
}

}  // namespace pliant::test::degrees_on_backend_suite

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
  std::vector<double> of_nodes(mesh.nodes.size());
  for (std::size_t i = 0; i < of_nodes.size(); ++i) of_nodes[i] = std::sin(double(i));
  auto values = upload(backend, of_nodes), by_host = upload(backend, of_nodes);
  ColoursOfTypes<A, C, B> colours(both.body), colours_by_host(both.host);
  both.body.on_backend_change([&](auto const& change) { values = change.carry_nodes(values); });
  both.host.on_backend_change([&](auto const& change) { by_host = change.carry_nodes(by_host); });
  auto const check = [&] {
    CHECK(colours.all() == colours_by_host.all());
    CHECK(download<double>(values) == download<double>(by_host));
    both.check_all();
  };
  for (int round = 0; round < 2; ++round) {
    convert_both(both, true, 2);
    check();
    both.refine_one_in(one_in);
    convert_both(both, false, 3);
    check();
    convert_both(both, true, one_in, 1);
    both.coarsen_all_but_one_in(12);
    check();
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

/// A body of groups of both types with the same laws, one that keeps what points have seen and one of values per element.
template <Element A, Element C, class B>
auto body_of_laws(B const& backend, Mesh<A, C> const& mesh, bool on_host) {
  constexpr int dim = A::dim;
  auto const graded = []<class E>(E) {
    return Formulation<E, Gauss<points<E>>, PerElement<NeoHookean>::law>{};
  };
  using GradedA = decltype(graded(A{}));
  using GradedC = decltype(graded(C{}));
  auto const relaxing = []<class E>(E) {
    return Group<Viscous<E>>{typename Viscous<E>::template law<double>{{3, 2}, {0.5}, {0.1}}};
  };
  Random random(5);
  std::vector<std::array<double, 2>> values(mesh.template elements<A>().size());
  for (auto& v : values) v = {4 + random(), 2 + random()};
  Body body{backend,
            mesh,
            soft,
            Group<GradedA>{.values = values},
            relaxing(A{}),
            Group<Soft<C>>{},
            Group<GradedC>{},
            relaxing(C{})};
  std::vector<Index> some;
  for (Index e = 0; e < static_cast<Index>(values.size()); e += 2) some.push_back(e);
  body.template assign<Viscous<A>>(some);
  std::vector<Point<dim>> u(mesh.nodes.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < dim; ++k)
      u[i][k] = 0.05 * mesh.nodes[i][(k + 1) % dim] * mesh.nodes[i][k];
  body.set_displacements(u);
  if (on_host) change_on_host(body);
  return body;
}

TEST_CASE("what points keep and laws read goes along where a body's backend raises and lowers",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element A, Element C>(Mesh<A, C> const& mesh) {
      auto body = body_of_laws(backend, mesh, false), host = body_of_laws(backend, mesh, true);
      double const dt = 0.1 * stable_step(host);
      Random random(2);
      std::vector<double> kept;
      for (int round = 0; round < 2; ++round) {
        for (auto* one : {&body, &host}) CentralDifference({.step = dt})(*one, 3);
        std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
        host.save(saved);
        body.load(saved);  // to the bit
        auto marked = random_marks(host, random, 2);
        auto lowered = random_marks(host, random, 2);
        marked[1].clear();
        CHECK(raise(body, marked).raised == raise(host, marked).raised);
        if (round > 0) {
          lowered[0].clear();
          CHECK(lower(body, lowered).lowered == lower(host, lowered).lowered);
        }
        REQUIRE(is_on_backend(body));
        check_same(body, host, std::numeric_limits<typename B::scalar>::epsilon());
      }
      auto const& table = std::get<1>(host.parts().layout.tables);
      kept = table.in_user_order(std::get<1>(host.state().elements).internal_variables);
      CHECK(std::ranges::any_of(kept, [](double x) { return x != 0; }));
      CHECK(std::ranges::count(user_groups<C>(std::as_const(host.parts())), Tag{1}) > 2);
    };
    check(mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)));
    check(mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
  });
}

}  // namespace pliant::test::degrees_on_backend_suite

#pragma once

#include <atomic>

#include <pliant/body/compare.hpp>

#include "adaptation/criteria.hpp"
#include "support/repeatable.hpp"
#include "support/replaying.hpp"
#include "support/small_patches.hpp"

// Looks between an integrator's steps pass over patches in which the forces of the next step tell that no element can
// act: the same elements switch as where all are looked at.
namespace pliant::test::screened_looks_suite {

template <class E>
using Linear = Formulation<E, Gauss<1>, Hooke>;
template <class E>
using Turned = Formulation<E, Gauss<1>, SaintVenantKirchhoff>;
template <class E>
using Rubber = Formulation<E, Gauss<1>, NeoHookean>;

/// |H|, which is bounded both ways.
struct GradientNorm {
  static constexpr Unit unit = Unit::one;
  static double least_gradient(double threshold, int) { return threshold; }
  static double most_gradient(double threshold, int) { return threshold; }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    auto const h = e.gradient();
    return sqrt(dot(h, h));
  }
};

/// Where a look behind recorded steps puts forces right, sums come in another order.
template <class B>
inline constexpr bool same_bits = std::same_as<typename B::Recording, HostRecording>;

template <class B>
auto patches_of(B const& backend) {
#if defined(__CUDACC__)
  return backend;
#else
  if constexpr (B::orders_by_group || !same_bits<B>)
    return backend;
  else
    return SmallPatches<typename B::scalar, 64>{};
#endif
}

/// Of several patches on every backend.
template <class E, class B>
auto mesh_for(B const&) {
  int const cells = B::orders_by_group ? 3 : 2;
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {4, 1}, .cells = {32 * cells, 12 * cells}});
  else
    return mesh::box<E>({.size = {4, 1, 1}, .cells = {8 * cells, 2 * cells, 3 * cells}});
}
/// Held at its left end, thrown at random at its right one.
template <class E, class B>
auto thrown(B const& backend, unsigned seed) {
  auto const mesh = mesh_for<E>(backend);
  Body body{backend,
            mesh,
            Elastic{.young = 1000, .poisson = 0.3, .density = 10},
            Group<Linear<E>>{},
            Group<Turned<E>>{},
            Group<Rubber<E>>{}};
  body.clamp(mesh.boundary("left"));
  auto v = rounded<float>(Random(seed).template field<E::dim>(mesh.nodes.size(), 1));
  for (std::size_t i = 0; i < v.size(); ++i)
    for (double& x : v[i]) x *= std::max(0.0, mesh.nodes[i][0] - 3);
  body.set_velocities(v);
  return body;
}
template <class E>
auto up_and_down() {
  return Adaptation{when<Linear<E>>(largest(EdgeLengthRatio{}, Rotation{}))
                        .above(0.01)
                        .template become<Turned<E>>(),
                    when<Turned<E>>(StrainNorm{}).above(0.03).template become<Rubber<E>>(),
                    when<Turned<E>>(largest(EdgeLengthRatio{}, Rotation{}))
                        .below(0.005)
                        .stay(20)
                        .template become<Linear<E>>(),
                    when<Rubber<E>>(inside(StrainNorm{}, Ball<E::dim>{{}, 9}))
                        .below(0.02)
                        .stay(20)
                        .template become<Turned<E>>()};
}
template <class E>
auto by_gradients() {
  return Adaptation{
      when<Linear<E>>(GradientNorm{}).above(0.015).template become<Turned<E>>(),
      when<Turned<E>>(GradientNorm{}).below(0.006).stay(16).template become<Linear<E>>()};
}
template <class E>
auto with_sleep() {
  return Adaptation{
      when<Linear<E>>(StrainNorm{}).above(0.01).template become<Turned<E>>(),
      when<Turned<E>>(StrainNorm{}).below(0.005).stay(20).template become<Linear<E>>(),
      sleep({.below = 1e-3, .for_steps = 16})};
}

template <class TheBody>
double moves(TheBody const& body) {
  double sum = 0;
  for (auto const& entry : ledger(body)) sum += entry.elements;
  return sum;
}

/// Two bodies, one of which looks at all elements.
template <class E, class B, class Rules>
void compare(B const& given, Rules const& rules, unsigned seed, double step = 0) {
  auto const backend = patches_of(given);
  using T = typename B::scalar;
  auto all = thrown<E>(backend, seed), screened = thrown<E>(backend, seed);
  CentralDifference one{{.safety = 0.5, .step = step}}, other{{.safety = 0.5, .step = step}};
  auto look = rules(), again = rules();
  for (int n : {64, 5, 90, 1}) {
    for (int k = 0; k < n; ++k) {
      one(all);
      look(all);
    }
    other(screened, n, again);
    REQUIRE(screened.steps() == all.steps());
    if (same_bits<B>) {
      REQUIRE(first_difference(all.state(), screened.state()) == "");
    } else if (sizeof(T) == 8) {
      CHECK(difference(screened.displacements(), all.displacements()) <
            1e-8 * largest(all.displacements()));
      CHECK(screened.template groups_of<E>() == all.template groups_of<E>());
      CHECK(std::abs(adaptation_energy(screened) - adaptation_energy(all)) < 1e-8);
    } else {
      CHECK(difference(screened.displacements(), all.displacements()) <
            2e-2 * largest(all.displacements()));
    }
  }
  REQUIRE(moves(all) > 50);
  CHECK(std::abs(moves(screened) - moves(all)) <= (sizeof(T) == 8 ? 0 : 0.02 * moves(all)));
}

TEST_CASE("rules tell the gradients outside which they do not act", "[adaptation]") {
  using From = Linear<Tri3>;
  using To = Turned<Tri3>;
  using Table = ElementTable<Reference<double>, Tri3, detail::TypeList<From, To>>;
  std::tuple const rules{when<From>(GradientNorm{}).above(0.1).become<To>(),
                         when<To>(GradientNorm{}).below(0.2).become<From>()};

  auto const of_from = detail::gradient_range<Table, 0, double, 2>(rules);
  auto const of_to = detail::gradient_range<Table, 1, double, 2>(rules);

  CHECK(of_from[0] == Approx(0.01).epsilon(0.01));
  CHECK(std::isinf(of_from[1]));
  CHECK(of_to[0] == -1);
  CHECK(of_to[1] == Approx(0.04).epsilon(0.01));
}

TEST_CASE("looks that forces screen switch what looks at all elements do", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const on = [&]<class E>(E) {
      compare<E>(
          backend, [] { return up_and_down<E>().every(1); }, 1);
      compare<E>(
          backend, [] { return up_and_down<E>(); }, 2);
      compare<E>(
          backend, [] { return by_gradients<E>().every(5); }, 3, 2e-4);
      compare<E>(
          backend, [] { return with_sleep<E>().every(4); }, 4);
    };
    on(Tet4{});
    if constexpr (runs_all<B>) on(Tri3{});
  });
}

#if !defined(__CUDACC__)
TEST_CASE("looks that forces screen in a recording switch what looks at all elements do",
          "[adaptation]") {
  Replaying<double, 64> const backend;
  compare<Tet4>(
      backend, [] { return up_and_down<Tet4>().every(1); }, 1);
  compare<Tet4>(
      backend, [] { return up_and_down<Tet4>(); }, 2);
  compare<Tet4>(
      backend, [] { return by_gradients<Tet4>().every(5); }, 3, 2e-4);
  compare<Tri3>(
      backend, [] { return up_and_down<Tri3>(); }, 4);
}

/// Counts how often it is evaluated, by as many elements as there are lanes.
struct Counted : EdgeLengthRatio {
  std::atomic<long>* calls;
  template <class State>
  auto operator()(State const& e) const {
    ++*calls;
    return EdgeLengthRatio::operator()(e);
  }
};

TEST_CASE("criteria are evaluated where forces tell that elements may act", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& given) {
    auto const backend = patches_of(given);
    std::atomic<long> calls = 0;
    Counted criterion{{}, &calls};
    auto body = thrown<Tet4>(backend, 1);
    CentralDifference step{{.safety = 0.5}};
    auto never = Adaptation{when<Linear<Tet4>>(criterion).above(0.9).become<Turned<Tet4>>()};
    step(body, 80, never);
    CHECK(calls.load() == 0);
    auto back = Adaptation{when<Linear<Tet4>>(criterion).above(0.9).become<Turned<Tet4>>(),
                           when<Rubber<Tet4>>(criterion).below(0.1).become<Turned<Tet4>>()};
    step(body, 16, back);  // nobody is in that group
    CHECK(calls.load() == 0);
    auto often = Adaptation{when<Linear<Tet4>>(criterion).above(0.01).become<Turned<Tet4>>()};
    step(body, 80, often);
    CHECK(calls.load() > 0);
    CHECK(moves(body) > 0);
    calls = 0;
    never.now(body);           // no steps follow
    CHECK(calls.load() == 0);  // but gradients bound these too
  });
}
#endif

TEST_CASE("what elements that move pull at is right for the step behind a look", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& given) {
    auto const backend = patches_of(given);
    auto body = thrown<Tet4>(backend, 5);
    auto look = up_and_down<Tet4>();
    CentralDifference step{{.safety = 0.5}};
    step(body, 64, look);
    REQUIRE(moves(body) > 50);
    auto const kept = body.forces();
    body.set_displacements(body.displacements());
    double const rounding = sizeof(typename B::scalar) == 8 ? 1e-12 : 1e-4;
    CHECK(difference(body.forces(), kept) <= rounding * largest(kept));
  });
}

}  // namespace pliant::test::screened_looks_suite

#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::own_actions_suite {

/// How much larger an element is than those around it: its volume less the mean of the means at its nodes.
struct LargerThanAround {
  double factor;
  template <class F>
  static constexpr int nodal_values = 5;  // the volume stands in the second block of four
  template <class State>
  PLIANT_HOST_DEVICE auto to_nodes(State const& e) const {
    auto told = Matrix<typename State::scalar, State::nodes, 5>::zero();
    for (int a = 0; a < State::nodes; ++a) told(a, 4) = e.volume();
    return told;
  }
  template <class State, class Means>
  PLIANT_HOST_DEVICE auto operator()(State const& e, Means const& means) const {
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    S sum(0);
    for (int a = 0; a < State::nodes; ++a) sum = sum + means(a, 4);
    return S(static_cast<T>(factor)) * (e.volume() - T(1.0 / State::nodes) * sum);
  }
};
static_assert(Criterion<LargerThanAround, Formulation<Tet10, Gauss<2>, Hooke>>);
static_assert(!Criterion<int, LinearOn<Quad4>>);

struct Volume {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.volume();
  }
};

/// Adds up what exceeds a limit, and counts.
template <class T>
struct AddUp {
  T limit;
  T *excess, *times;  // (elements)
  PLIANT_HOST_DEVICE bool action_needed(T value) const { return value > limit; }
  PLIANT_HOST_DEVICE void action(Index element, T value) const {
    excess[element] += value - limit;
    times[element] += 1;
  }
};
static_assert(Strategy<AddUp<float>, float>);
static_assert(!Strategy<Volume, float>);

TEST_CASE("a user's criterion takes means at nodes, weighted by volume", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(3);
    FieldOf<std::size_t{E::dim}> const at_rest(mesh.nodes.size());
    auto const volume = values_at<E>(backend, mesh, at_rest, Volume{});

    auto const found = values_at<E>(backend, mesh, at_rest, LargerThanAround{2});

    auto const& elements = mesh.template elements<E>();
    std::vector<double> sum(mesh.nodes.size()), weight(mesh.nodes.size());
    for (std::size_t e = 0; e < elements.size(); ++e)
      for (Index n : elements[e]) {
        sum[static_cast<std::size_t>(n)] += volume[e] * volume[e];
        weight[static_cast<std::size_t>(n)] += volume[e];
      }
    double const tolerance = 1e2 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    for (std::size_t e = 0; e < elements.size(); ++e) {
      double around = 0;
      for (Index n : elements[e])
        around += sum[static_cast<std::size_t>(n)] / weight[static_cast<std::size_t>(n)];
      CHECK(found[e] ==
            Approx(2 * (volume[e] - around / E::nodes)).epsilon(1e-5).margin(tolerance));
    }
  });
}

TEST_CASE("rules with criteria of means that differ in their data do not mix them up",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using A = Formulation<Quad4, Gauss<2>, Hooke>;
    using C = Formulation<Quad4, Gauss<2>, NeoHookean>;
    using D = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
    auto const mesh = distorted_mesh<Quad4>(6);
    Body body{backend, mesh, soft, Group<A>{}, Group<C>{}, Group<D>{}};
    auto const value = evaluate<Quad4>(body, LargerThanAround{1});
    double limit = 0;
    for (double v : value) limit = std::max(limit, v / 2);

    Adaptation{when<A>(LargerThanAround{1}).above(limit).template become<C>(),
               when<A>(LargerThanAround{-1}).above(limit).template become<D>()}
        .now(body);

    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < value.size(); ++e)
      CHECK(groups[e] == (value[e] > limit ? 1 : value[e] < -limit ? 2 : 0));
    CHECK(std::ranges::count(groups, 1) > 0);
    CHECK(std::ranges::count(groups, 2) > 0);
  });
}

TEST_CASE("a strategy's own action is taken where it is needed, in the user's order",
          "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    using A = Formulation<Tri3, Gauss<1>, Hooke>;
    using C = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const mesh = distorted_mesh<Tri3>(5);
    Body body{backend, mesh, soft, Group<A>{}, Group<C>{}};
    body.template assign<C>({1, 2, 3, 5, 8, 13});
    body.set_displacements(Random(4).field<2>(mesh.nodes.size(), 0.02));
    auto const value = evaluate<Tri3>(body, StrainNorm{});
    auto const groups = body.template groups_of<Tri3>();
    auto const forces = body.forces();
    auto excess = zeros<T>(backend, value.size()), times = zeros<T>(backend, value.size());
    auto sorted = value;
    std::ranges::sort(sorted);
    auto const limit = static_cast<T>((sorted[10] + sorted[11]) / 2);

    adapt<A>(body, StrainNorm{}, AddUp<T>{limit, excess.data(), times.data()});
    adapt<A>(body, inside(StrainNorm{}, Box<2>{{{{-9}, {-9}}}, {{{0.2}, {9}}}}),
             AddUp<T>{limit, excess.data(), times.data()});

    auto const found = download<T>(excess), counts = download<T>(times);
    int twice = 0;
    for (std::size_t e = 0; e < value.size(); ++e) {
      double x = 0;
      for (Index n : mesh.elements<Tri3>()[e]) x += mesh.nodes[static_cast<std::size_t>(n)][0] / 3;
      int const expected = groups[e] == 1 || value[e] < limit ? 0 : x < 0.2 ? 2 : 1;
      CHECK(counts[e] == static_cast<T>(expected));
      CHECK(found[e] == Approx(expected * (value[e] - limit)).epsilon(1e-4).margin(1e-6));
      twice += expected == 2;
    }
    CHECK(twice > 3);
    CHECK(difference(body.forces(), forces) == 0);
  });
}

}  // namespace pliant::test::own_actions_suite

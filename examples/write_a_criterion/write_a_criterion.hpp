#pragma once

#include <cstdio>

#include <pliant/pliant.hpp>

// A criterion is a number for an element, here also from its neighbours; a strategy is what then happens to the
// element. This file adds both, and has them look at a bracket that is loaded at once, on any backend.
namespace write_a_criterion {
using namespace pliant;

/// How far an element's energy density is from the mean of its surroundings, over that mean.
struct Unevenness {
  static constexpr Unit unit = Unit::one;  // lets it be calculated with
  template <class F>
  static constexpr int nodal_values = 1;
  template <class State>  // what an element tells its nodes
  PLIANT_HOST_DEVICE auto to_nodes(State const& e) const {
    Matrix<typename State::scalar, State::nodes, 1> told;
    for (int a = 0; a < State::nodes; ++a) told(a, 0) = EnergyDensity{}(e);
    return told;
  }
  template <class State, class Means>  // the means at its nodes, of the elements around them
  PLIANT_HOST_DEVICE auto operator()(State const& e, Means const& means) const {
    auto mean = means(0, 0);
    for (int a = 1; a < State::nodes; ++a) mean = mean + means(a, 0);
    mean = mean / typename State::scalar(State::nodes);
    return abs(EnergyDensity{}(e)-mean) / mean;
  }
};

/// A strategy: metal tires of each look at which its stress is above a limit.
template <class T>
struct Fatigue {
  T limit;    // Pa
  T* damage;  // (elements), in the backend's memory
  PLIANT_HOST_DEVICE bool action_needed(T stress) const { return stress > limit; }
  PLIANT_HOST_DEVICE void action(Index element, T stress) const {
    damage[element] += (stress / limit - 1) * T(0.1);
  }
};

template <class B>
void run(B const& backend) {
  auto const mesh = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {16, 16}});
  using Metal = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  Body bracket{backend, mesh, {.young = 1e7, .poisson = 0.3, .density = 1000}, Group<Metal>{}};
  bracket.clamp(mesh.boundary("left"));
  bracket.set_loads(traction_loads(mesh, mesh.boundary("top"), Point<2>{0, -2e4}));
  bracket.set_damping(50);
  auto damage = zeros<typename B::scalar>(backend, mesh.template elements<Quad4>().size());
  CentralDifference step;
  Adaptation refinement{when<Metal>(Unevenness{}).above(0.5).refine({.max_level = 2})};
  for (int look = 0; look < 10; ++look) {
    step(bracket, 100);
    adapt<Metal>(bracket, VonMises{}, Fatigue<typename B::scalar>{5e4, damage.data()});
  }
  double worst = 0, sum = 0;
  for (double d : download<typename B::scalar>(damage)) {
    worst = std::max(worst, d);
    sum += d > 0;
  }
  refinement.now(bracket);
  std::printf("%.0f elements are tired, the worst by %.3f; of %zu there are %zu after refinement\n",
              sum, worst, mesh.template elements<Quad4>().size(),
              bracket.mesh().template elements<Quad4>().size());
}
}  // namespace write_a_criterion

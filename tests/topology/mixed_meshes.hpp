#pragma once

#include <cmath>
#include <map>
#include <span>
#include <sstream>
#include <type_traits>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// What tests of bodies with elements of several types share, whose types change.
namespace pliant::test {

template <std::size_t Type, class TheBody>
auto const& elements(TheBody const& body) {
  return std::get<Type>(body.mesh().tables);
}
/// One in so many elements of a type, or of all types (−1), at random.
template <class TheBody>
std::vector<std::vector<Index>> some(TheBody const& body, std::size_t one_in, Random& random,
                                     int type_wanted) {
  std::vector<std::vector<Index>> lists;
  detail::for_each_type_of<std::remove_cvref_t<decltype(body.mesh())>>(
      [&]<Element E>(E, std::size_t type) {
        auto& own = lists.emplace_back();
        auto const count = static_cast<Index>(body.mesh().template elements<E>().size());
        for (Index e = 0; e < count; ++e)
          if ((type_wanted < 0 || type == static_cast<std::size_t>(type_wanted)) &&
              random.below(one_in) == 0)
            own.push_back(e);
      });
  return lists;
}
template <class TheBody>
std::vector<std::vector<Index>> all(TheBody const& body, int type_wanted) {
  Random random(1);
  return some(body, 1, random, type_wanted);
}
inline std::vector<Index> first_numbers(std::size_t count) {
  std::vector<Index> list(count);
  for (std::size_t e = 0; e < count; ++e) list[e] = static_cast<Index>(e);
  return list;
}

template <int Dim>
Tensor<double, Dim> some_gradient() {
  auto h = Tensor<double, Dim>::zero();
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      h(i, j) = 0.03 * (1 + i) - 0.05 * j + (i == j ? 0.04 : 0.02 * i * j);
  return h;
}
template <class TheBody>
Point<TheBody::dim> momentum(TheBody& body) {
  auto p = body.velocities();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (double& x : p[i]) x *= body.parts().layout.mass_list()[i];
  return total(p);
}

/// All elements of a type go to the group of a formulation.
template <class F, class TheBody>
void assign_all(TheBody& body) {
  body.template assign<F>(
      first_numbers(body.mesh().template elements<typename F::element>().size()));
}

/// Of a body all of whose elements go by the law of F: a linear displacement makes a uniform state.
template <class F, class TheBody>
void check_patch(TheBody& body) {
  auto const& mesh = body.mesh();
  auto const h = some_gradient<TheBody::dim>();
  auto const f = forces_at(body, uniform(mesh.nodes, h));
  double inside = 0;
  std::vector<bool> outside(mesh.nodes.size(), false);
  for (auto const& [name, facets] : mesh.boundaries)
    for (Index i : nodes_of(facets)) outside[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < f.size(); ++i)
    for (double x : f[i])
      if (!outside[i]) inside = std::max(inside, std::abs(x));
  CHECK(inside < 1e-13);
  CHECK(strain_energy(body) == Approx(energy_density(law_at_a_point<F>(body), h)).epsilon(1e-12));
}

/// Calls look_at(xi) at the places of a grid on the sides of a cell: n + 1 along an edge.
template <class Cell, class LookAt>
void on_sides(int n, LookAt const& look_at) {
  for (auto const& side : Cell::sides()) {
    bool const triangle = side.size() == 4 && side[side.size() - 1] < 0;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= (Cell::dim == 3 ? n : 0); ++j) {
        if (triangle && i + j > n) continue;
        double const s = i / double(n), t = j / double(n);
        double const weights[] = {triangle ? 1 - s - t : (1 - s) * (1 - t),
                                  triangle ? s : s * (1 - t), triangle ? t : s * t,
                                  triangle ? 0 : (1 - s) * t};
        auto xi = Vector<double, Cell::dim>::zero();
        for (std::size_t k = 0; k < side.size(); ++k)
          if (side[k] >= 0) xi = xi + weights[k] * Cell::corner(side[k]);
        look_at(xi);
      }
  }
}

/// At all places of a grid on the sides of each element: where such places of others coincide, displacements agree, and
/// the places of fine elements are among those of coarse ones.
template <class TheBody>
void check_continuity(TheBody& body, Random& random) {
  constexpr int dim = TheBody::dim;
  body.set_displacements(random.template field<dim>(body.mesh().nodes.size(), 1));
  auto const u = body.displacements();
  auto const& mesh = body.mesh();
  FieldOf<dim> places, values;
  detail::for_each_type_of<std::remove_cvref_t<decltype(mesh)>>([&]<Element E>(E, std::size_t) {
    for (auto const& nodes : mesh.template elements<E>())
      on_sides<typename E::cell>(16, [&](auto const& xi) {  // of the coarsest; levels up to 3
        auto const shape = E::shape(xi);
        auto& value = values.emplace_back();
        auto& place = places.emplace_back();
        for (int a = 0; a < E::nodes; ++a)
          for (std::size_t k = 0; k < dim; ++k) {
            auto const node = static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)]);
            value[k] += shape[a] * u[node][k];
            place[k] += shape[a] * mesh.nodes[node][k];
          }
      });
  });
  std::map<std::array<long, 3>, Point<dim>> seen;
  double worst = 0;
  std::size_t met = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::array<long, 3> key{};
    for (std::size_t k = 0; k < dim; ++k) key[k] = std::lround(places[i][k] * 1e9);
    auto const [at, is_new] = seen.emplace(key, values[i]);
    if (is_new) continue;
    ++met;
    for (std::size_t k = 0; k < dim; ++k)
      worst = std::max(worst, std::abs(at->second[k] - values[i][k]));
  }
  CHECK(met > places.size() / 20);
  CHECK(worst < 1e-12);
}

/// change(body, random) changes the mesh and undo(body) brings back the one of the beginning: a linear displacement, its
/// energy and the momentum are kept, and a uniform velocity to the bit.
template <class TheBody, class Change, class Undo>
void check_what_is_kept(TheBody& body, Change const& change, Undo const& undo) {
  constexpr int dim = TheBody::dim;
  auto const mesh = body.mesh();
  Random random(8);
  auto const u = uniform(mesh.nodes, some_gradient<dim>());
  body.set_displacements(u);
  body.set_velocities(random.template field<dim>(mesh.nodes.size(), 1));
  auto const before = momentum(body);
  double const energy = strain_energy(body);

  change(body, random);

  auto const expected = uniform(body.mesh().nodes, some_gradient<dim>());
  CHECK(difference(body.displacements(), expected) < 1e-14);
  CHECK(strain_energy(body) == Approx(energy).epsilon(1e-12));
  auto const mixed = momentum(body);
  for (std::size_t k = 0; k < dim; ++k) CHECK(mixed[k] == Approx(before[k]).margin(1e-13));
  auto const& mass = body.parts().layout.mass_list();
  std::vector<bool> hangs(mass.size(), false);
  for (auto const& slave : body.mesh().slaves) hangs[static_cast<std::size_t>(slave.node)] = true;
  for (std::size_t i = 0; i < mass.size(); ++i) CHECK((hangs[i] ? mass[i] == 0 : mass[i] > 0));

  undo(body);

  CHECK(body.displacements() == u);
  auto const after = momentum(body);
  for (std::size_t k = 0; k < dim; ++k) CHECK(after[k] == Approx(before[k]).margin(1e-13));
  CHECK(body.mesh().nodes == mesh.nodes);
  CHECK(body.mesh().tables == mesh.tables);
  CHECK(body.mesh().boundaries == mesh.boundaries);
  CHECK(body.mesh().slaves.empty());

  Point<dim> v{};
  for (std::size_t k = 0; k < dim; ++k) v[k] = 0.3 - 0.7 * static_cast<double>(k);
  body.set_velocities(FieldOf<dim>(mesh.nodes.size(), v));
  change(body, random);
  for (auto const& own : body.velocities()) CHECK(own == v);
  undo(body);
  for (auto const& own : body.velocities()) CHECK(own == v);
}

/// A body of changed types steps, and one that takes its place by save and load goes on with the same.
template <class Make, class Change, class Undo>
void check_resuming(Make const& make, Change const& change, Undo const& undo) {
  auto body = make();
  constexpr int dim = decltype(body)::dim;
  auto const run = [](auto& own, int steps) {
    CentralDifference step({.step = 1e-3});
    step(own, steps);
  };
  Random random(12);
  body.set_velocities(random.template field<dim>(body.mesh().nodes.size(), 0.1));
  change(body, random);
  run(body, 5);
  std::stringstream file;
  body.save(file);
  auto other = make();
  other.load(file);
  for (auto* own : {&body, &other}) {
    run(*own, 3);
    undo(*own);
    run(*own, 3);
  }
  CHECK(body.mesh().nodes == other.mesh().nodes);
  CHECK(body.mesh().tables == other.mesh().tables);
  for (auto const& x : body.displacements())
    for (double y : x) CHECK(std::isfinite(y));
  CHECK(difference(body.displacements(), other.displacements()) <= between_runs(1e-14));
}

/// make(backend) makes a body, of which change(body, random) changes the mesh: forces are those of the Reference backend.
template <class B, class Make, class Change>
void check_agreement(B const& backend, Make const& make, Change const& change) {
  auto const changed = [&](auto const& on) {
    auto body = make(on);
    constexpr int dim = decltype(body)::dim;
    Random random(7);
    change(body, random);
    body.set_displacements(random.template field<dim>(body.mesh().nodes.size(), 0.002));
    return body;
  };
  auto body = changed(backend);
  auto reference = changed(Reference<double>{});
  REQUIRE(body.mesh().nodes == reference.mesh().nodes);
  REQUIRE(body.mesh().tables == reference.mesh().tables);
  auto const f = body.forces(), expected = reference.forces();
  double const scale = largest(expected);
  for (std::size_t i = 0; i < f.size(); ++i)
    for (std::size_t k = 0; k < f[i].size(); ++k)
      CHECK(f[i][k] == Approx(expected[i][k]).margin(1e-12 * scale));
}

}  // namespace pliant::test

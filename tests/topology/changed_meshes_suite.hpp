#pragma once

#include <sstream>

#include <pliant/topology/hierarchy.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// Bodies of every element whose mesh is refined and coarsened at random.
namespace pliant::test::changed_meshes_suite {

using OfAllElements =
    List<Formulation<Tri3, Gauss<1>, NeoHookean>, Formulation<Tri6, Gauss<2>, NeoHookean>,
         Formulation<Quad4, Gauss<2>, NeoHookean>, Formulation<Quad8, Gauss<3>, NeoHookean>,
         Formulation<Quad9, Gauss<3>, NeoHookean>, Formulation<Tet4, Gauss<1>, NeoHookean>,
         Formulation<Tet10, Gauss<2>, NeoHookean>, Formulation<Hex8, Gauss<2>, NeoHookean>,
         Formulation<Hex20, Gauss<3>, NeoHookean>, Formulation<Hex27, Gauss<3>, NeoHookean>,
         Formulation<Wedge6, Gauss<2>, NeoHookean>>;
using OfSolids =
    List<Formulation<Tet4, Gauss<1>, NeoHookean>, Formulation<Hex8, Gauss<2>, NeoHookean>>;
/// Those whose forces are compared with the serial backend's: all of a GPU, and on CPUs hanging nodes that take from
/// two others, from three, and from four.
using Compared = std::conditional_t<
    runs_all<Reference<double>>, OfAllElements,
    List<Formulation<Tri3, Gauss<1>, NeoHookean>, Formulation<Quad8, Gauss<3>, NeoHookean>,
         Formulation<Tet4, Gauss<1>, NeoHookean>, Formulation<Hex8, Gauss<2>, NeoHookean>>>;
template <class B>
using elements_on = std::conditional_t<std::same_as<B, MainBackend>, OfAllElements, OfSolids>;

/// Calls visit(Case<B, F>): all elements on the main backend, two on the others.
template <class Bs, class Visit>
void on_elements(Visit const& visit) {
  [&]<class... B>(std::tuple<B...> const*) {
    (on_each_of<B>(elements_on<B>{}, visit), ...);
  }(static_cast<Bs const*>(nullptr));
}

template <Element E>
Mesh<E> initial_mesh() {
  return distorted_mesh<E>(E::dim == 2 ? 4 : 2);
}

template <class TheBody>
auto const& elements(TheBody const& body) {
  return std::get<0>(body.mesh().tables);
}
/// Refines some elements at random twice, and merges most families once between.
template <class TheBody>
void change(TheBody& body, Random& random) {
  auto const some = [&](std::size_t one_in) {
    std::vector<Index> list;
    for (Index e = 0; e < static_cast<Index>(elements(body).size()); ++e)
      if (random.below(one_in) == 0) list.push_back(e);
    if (list.empty()) list.push_back(0);
    return list;
  };
  bool const solid = TheBody::dim == 3;
  refine(body, {some(solid ? 3 : 2)}, 3);
  refine(body, {some(solid ? 12 : 4)}, 3);
  std::vector<Index> most;
  for (Index e = 0; e < static_cast<Index>(elements(body).size()); ++e)
    if (random.below(30) > 0) most.push_back(e);
  coarsen(body, {most});
  refine(body, {some(solid ? 12 : 4)}, 3);
}
template <class TheBody>
void coarsen_all(TheBody& body) {
  for (;;) {
    std::vector<Index> all(elements(body).size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
    if (coarsen(body, {all}).merged == 0) return;
  }
}
template <class TheBody>
Point<TheBody::dim> momentum(TheBody& body) {
  auto p = body.velocities();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (double& x : p[i]) x *= body.parts().layout.mass_list()[i];
  return total(p);
}
template <int Dim>
Tensor<double, Dim> some_gradient() {
  auto h = Tensor<double, Dim>::zero();
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      h(i, j) = 0.03 * (1 + i) - 0.05 * j + (i == j ? 0.04 : 0.02 * i * j);
  return h;
}

TEST_CASE("a changed mesh passes the patch test", "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto body = body_of<F>(B{}, initial_mesh<typename F::element>());
    Random random(5);
    change(body, random);
    auto const& mesh = body.mesh();
    REQUIRE_FALSE(mesh.slaves.empty());
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    auto const h = some_gradient<dim>();

    auto const f = forces_at(body, uniform(mesh.nodes, h));

    double inside = 0;
    for (Index i : inner_nodes(mesh))
      for (double x : f[static_cast<std::size_t>(i)]) inside = std::max(inside, std::abs(x));
    CHECK(inside < 1e-13);
    auto const p = stress(law_at_a_point<F>(body), h);
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) {
        auto g = Tensor<double, dim>::zero();
        g(i, k) = 1;
        CHECK(-inner(f, uniform(mesh.nodes, g)) == Approx(p(i, k)).margin(1e-12));
      }
    CHECK(strain_energy(body) == Approx(energy_density(law_at_a_point<F>(body), h)).epsilon(1e-12));
  });
}

TEST_CASE("a changed mesh does not resist rigid motion, and forces on it balance", "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto body = body_of<F>(B{}, initial_mesh<typename F::element>());
    Random random(6);
    change(body, random);
    auto rotation = Tensor<double, dim>::zero();
    rotation(0, 0) = rotation(1, 1) = std::cos(0.7) - 1;
    rotation(1, 0) = std::sin(0.7);
    rotation(0, 1) = -std::sin(0.7);
    CHECK(largest(forces_at(body, uniform(body.mesh().nodes, rotation))) < 1e-13);

    auto const f =
        forces_at(body, random.field<dim>(body.mesh().nodes.size(), dim == 2 ? 0.002 : 0.004));
    auto const sum = total(f);
    double moment = 0;
    auto const u = body.displacements();
    for (std::size_t i = 0; i < f.size(); ++i)
      moment += (body.mesh().nodes[i][0] + u[i][0]) * f[i][1] -
                (body.mesh().nodes[i][1] + u[i][1]) * f[i][0];
    CHECK(largest(f) > 1e-4);
    for (double x : sum) CHECK(std::abs(x) < 1e-13);
    CHECK(std::abs(moment) < 1e-13);
  });
}

TEST_CASE("forces on a changed mesh are the same on all backends", "[topology]") {
  on_each_of<MainBackend>(Compared{}, []<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto const changed = [](auto const& backend) {
      auto body = body_of<F>(backend, initial_mesh<typename F::element>());
      Random random(7);
      body.set_velocities(random.field<dim>(body.mesh().nodes.size(), 1));
      change(body, random);
      body.set_displacements(random.field<dim>(body.mesh().nodes.size(), 0.002));
      return body;
    };
    auto body = changed(B{});
    auto reference = changed(Reference<double>{});
    REQUIRE(body.mesh().nodes == reference.mesh().nodes);
    REQUIRE(elements(body) == elements(reference));

    auto const f = body.forces(), expected = reference.forces();

    double const scale = largest(expected);
    for (std::size_t i = 0; i < f.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        CHECK(f[i][k] == Approx(expected[i][k]).margin(1e-12 * scale));
    CHECK(stable_step(body) == Approx(stable_step(reference)).epsilon(1e-3));
  });
}

TEST_CASE(
    "the stable step bounds the highest frequency of a changed mesh, whose masses are positive",
    "[topology]") {
  on_each_of<HostBackend>(OfAllElements{}, []<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto body = body_of<F>(B{}, initial_mesh<typename F::element>());
    Random random(13);
    change(body, random);
    auto const& mass = body.parts().layout.mass_list();
    std::vector<bool> hangs(mass.size(), false);
    for (auto const& slave : body.mesh().slaves) hangs[static_cast<std::size_t>(slave.node)] = true;
    for (std::size_t i = 0; i < mass.size(); ++i) CHECK((hangs[i] ? mass[i] == 0 : mass[i] > 0));

    // Power iteration, from below.
    auto const size = dim * mass.size();
    std::vector<double> const u(size, 0.0);
    std::vector<double> v(size), f(size);
    for (double& x : v) x = random();
    double frequency = 0;
    for (int k = 0; k < 60; ++k) {
      std::ranges::fill(f, 0.0);
      body.add_tangent_product(u.data(), v.data(), f.data(), -1.0);
      double norm = 0;
      for (std::size_t i = 0; i < size; ++i) {
        v[i] = hangs[i / dim] ? 0 : f[i] / mass[i / dim];
        norm += v[i] * v[i];
      }
      frequency = std::sqrt(norm);
      for (double& x : v) x /= frequency;
    }
    double const bound = 4 / square(stable_step(body));
    CHECK(bound >= frequency);
    CHECK(bound < 12 * frequency);
  });
}

TEST_CASE("changes of the mesh keep momentum, and rigid translation exactly", "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto body = body_of<F>(B{}, initial_mesh<typename F::element>());
    Random random(8);
    body.set_velocities(random.field<dim>(body.mesh().nodes.size(), 1));
    body.set_displacements(random.field<dim>(body.mesh().nodes.size(), 0.01));
    auto const before = momentum(body);
    change(body, random);
    coarsen_all(body);
    auto const after = momentum(body);
    for (std::size_t k = 0; k < dim; ++k) CHECK(after[k] == Approx(before[k]).margin(1e-13));
    CHECK(ledger(body).size() > 4);

    Point<dim> v{};
    for (std::size_t k = 0; k < dim; ++k) v[k] = 0.3 - 0.7 * static_cast<double>(k);
    body.set_velocities(FieldOf<dim>(body.mesh().nodes.size(), v));
    change(body, random);
    for (auto const& own : body.velocities()) CHECK(own == v);
    coarsen_all(body);
    for (auto const& own : body.velocities()) CHECK(own == v);
  });
}

/// Serendipity elements that are no parallelograms have linear fields alone.
template <class F>
inline constexpr bool has_quadratic_fields =
    F::element::degree == 2 &&
    (SimplexCell<typename F::element::cell> || F::element::lumping == Lumping::nodal);

/// A polynomial that the elements represent exactly.
template <class F>
Point<F::dim> field_at(Point<F::dim> const& x) {
  Point<F::dim> u{};
  for (std::size_t k = 0; k < F::dim; ++k) {
    u[k] = 0.01 * x[0] - 0.02 * x[1] + 0.03 * x[k];
    if (has_quadratic_fields<F>) u[k] += 0.02 * x[0] * x[1] - 0.01 * x[k] * x[k];
  }
  return u;
}

TEST_CASE("changes of the mesh leave fields that it can represent as they are", "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    auto const mesh = initial_mesh<typename F::element>();
    auto body = body_of<F>(B{}, mesh);
    FieldOf<F::dim> u;
    for (auto const& x : mesh.nodes) u.push_back(field_at<F>(x));
    body.set_displacements(u);
    double const energy = strain_energy(body);
    Random random(9);

    change(body, random);

    auto const now = body.displacements();
    for (std::size_t i = 0; i < now.size(); ++i) {
      auto const exact = field_at<F>(body.mesh().nodes[i]);
      for (std::size_t k = 0; k < F::dim; ++k) CHECK(now[i][k] == Approx(exact[k]).margin(1e-15));
    }
    CHECK(strain_energy(body) == Approx(energy).epsilon(has_quadratic_fields<F> ? 1e-3 : 1e-12));

    coarsen_all(body);

    CHECK(body.displacements() == u);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(elements(body) == std::get<0>(mesh.tables));
    CHECK(body.mesh().slaves.empty());
    CHECK(body.mesh().boundaries == mesh.boundaries);
    CHECK(strain_energy(body) == energy);
  });
}

TEST_CASE("boundaries, conditions, pressures and loads follow a changed mesh and come back",
          "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto const mesh = initial_mesh<typename F::element>();
    auto body = body_of<F>(B{}, mesh);
    auto const left = body.clamp(mesh.boundary("left"));
    body.press(mesh.boundary("right"), 0.25);
    body.press(mesh.boundary("top"), 0.5);
    (void)left;
    auto const at_rest = body.forces();
    Random random(10);

    change(body, random);

    auto const& now = body.mesh();
    for (auto const& [name, facets] : mesh.boundaries) {
      INFO(name);
      // The normals of a side's parts add up to that of the side: it is covered once, seen from outside.
      auto const normal = [&](auto const& m, auto const& list) {
        Point<dim> sum{};
        for (auto const& facet : list) {
          auto const x = [&](std::size_t corner) {
            return m.nodes[static_cast<std::size_t>(facet[corner])];
          };
          if constexpr (dim == 2) {
            sum[0] += x(1)[1] - x(0)[1];
            sum[1] -= x(1)[0] - x(0)[0];
          } else {
            for (std::size_t c = 2; c < facet.corners(); ++c)
              for (std::size_t k = 0; k < 3; ++k) {
                auto const i = (k + 1) % 3, j = (k + 2) % 3;
                sum[k] += ((x(c - 1)[i] - x(0)[i]) * (x(c)[j] - x(0)[j]) -
                           (x(c - 1)[j] - x(0)[j]) * (x(c)[i] - x(0)[i])) /
                          2;
              }
          }
        }
        return sum;
      };
      auto const was = normal(mesh, facets), is = normal(now, now.boundary(name));
      for (std::size_t k = 0; k < dim; ++k) CHECK(is[k] == Approx(was[k]).margin(1e-13));
    }
    auto const& prescribed = *body.state().prescribed;
    CHECK(prescribed.conditions[0].nodes == nodes_of(now.boundary("left")));
    CHECK(prescribed.pressures[0].facets == now.boundary("right"));
    for (auto const& facet : now.boundary("top"))
      CHECK(facet.size() == mesh.boundary("top")[0].size());
    // Pressure's force is the same in all, on whatever nodes.
    auto const f = body.forces();
    for (std::size_t k = 0; k < dim; ++k)
      CHECK(total(f)[k] == Approx(total(at_rest)[k]).margin(1e-13));

    Point<dim> load{};
    load[1] = 0.125;
    body.set_load(static_cast<Index>(now.nodes.size()) - 1, load);
    coarsen_all(body);

    CHECK(body.mesh().boundaries == mesh.boundaries);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(mesh.boundary("left")));
    Point<dim> sum{};
    for (auto const& own : nodal_loads(body))
      for (std::size_t k = 0; k < dim; ++k) sum[k] += own[k];
    for (std::size_t k = 0; k < dim; ++k) CHECK(sum[k] == Approx(load[k]).margin(1e-15));
  });
}

TEST_CASE("what a condition names is not merged away", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::box<Hex8>({.size = {2, 1, 1}, .cells = {2, 1, 1}});
    using F = Formulation<Hex8, Gauss<2>, Hooke>;
    auto const refined = [&] {
      auto body = body_of<F>(backend, mesh);
      refine(body, {{0, 1}});
      return body;
    };
    {
      auto body = refined();
      auto const n = body.nodes();
      Index inside = -1;  // of the first cell
      for (Index i = 0; i < n; ++i)
        if (body.mesh().nodes[static_cast<std::size_t>(i)] == Point<3>{0.5, 0.5, 0.5}) inside = i;
      REQUIRE(inside >= 0);
      auto const spot = body.clamp(std::vector<Index>{inside});
      coarsen_all(body);
      CHECK(elements(body).size() == 9);
      auto const& held = body.state().prescribed->conditions[0].nodes;
      REQUIRE(held.size() == 1);
      CHECK(body.mesh().nodes[static_cast<std::size_t>(held[0])] == Point<3>{0.5, 0.5, 0.5});
      body.release(spot);
      coarsen_all(body);
      CHECK(elements(body).size() == 2);
    }
    {
      auto body = refined();
      auto part = body.mesh().boundary("left");
      REQUIRE(part.size() == 4);
      part.pop_back();
      body.press(part, 1);
      coarsen_all(body);
      CHECK(elements(body).size() == 9);
      CHECK(body.state().prescribed->pressures[0].facets.size() == 3);
    }
  });
}

TEST_CASE("a refined and coarsened body steps, saves and resumes", "[topology]") {
  on_elements<DoubleBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    auto const run = [](auto& body, int steps) {
      CentralDifference step({.step = 1e-3});
      step(body, steps);
    };
    auto body = body_of<F>(B{}, initial_mesh<typename F::element>());
    Random random(12);
    body.set_velocities(random.field<dim>(body.mesh().nodes.size(), 0.1));
    change(body, random);
    run(body, 5);
    std::stringstream file;
    body.save(file);
    auto other = body_of<F>(B{}, initial_mesh<typename F::element>());
    other.load(file);
    for (auto* own : {&body, &other}) {
      run(*own, 3);
      coarsen_all(*own);
      run(*own, 3);
    }
    CHECK(body.mesh().nodes == other.mesh().nodes);
    CHECK(elements(body) == elements(other));
    for (auto const& x : body.displacements())
      for (double y : x) CHECK(std::isfinite(y));
    CHECK(difference(body.displacements(), other.displacements()) <= between_runs(1e-14));
  });
}

TEST_CASE("what a rule refines is not merged by another", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tet4, Gauss<1>, Hooke>;
    auto body = body_of<F>(backend, mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {2, 2, 2}}));
    auto const count = body.mesh().template elements<Tet4>().size();
    Adaptation adapt{when<F>(StrainNorm{}).above(0.02).refine({.max_level = 2}),
                     when<F>(StrainNorm{}).above(0.01).coarsen()};
    for (std::size_t const more : {std::size_t{8}, std::size_t{64}}) {
      auto u = body.mesh().nodes;
      for (auto& x : u) x = {0.05 * x[0], 0, 0};
      body.set_displacements(u);
      adapt.now(body);
      CHECK(body.mesh().template elements<Tet4>().size() == more * count);
    }
  });
}

TEST_CASE("a rule coarsens behind what another refines", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tet4, Gauss<1>, Hooke>;
    auto const mesh = mesh::box<Tet4>({.size = {2, 1, 1}, .cells = {4, 2, 2}});
    auto body = body_of<F>(backend, mesh);
    Adaptation adapt{when<F>(StrainNorm{}).above(0.02).refine({.max_level = 1}),
                     when<F>(StrainNorm{}).below(0.01).coarsen()};
    // A stretched band moves along x.
    auto const stretch = [&](double from) {
      FieldOf<3> u;
      for (auto const& x : body.mesh().nodes)
        u.push_back({0.05 * std::clamp(x[0] - from, 0.0, 0.5), 0, 0});
      body.set_displacements(u);
    };
    std::size_t const first = std::get<0>(mesh.tables).size();
    stretch(0);
    adapt.now(body);
    std::size_t const once = elements(body).size();
    CHECK(once >= first + 7 * first / 4);
    stretch(1.5);
    adapt.now(body);
    stretch(1.5);
    adapt.now(body);
    CHECK(elements(body).size() == once);
    for (auto const& node : body.mesh().nodes)  // the fine cells are on the other side now
      CHECK((node[0] > 0.7 || 4 * node[0] == std::floor(2 * node[0]) * 2));
    stretch(5);
    adapt.now(body);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(elements(body) == std::get<0>(mesh.tables));
    CHECK_THROWS_WITH(when<F>(StrainNorm{}).below(0.01).coarsen({.min_level = -1}),
                      says("min_level of -1"));
    CHECK_THROWS_WITH(when<F>(StrainNorm{}).below(0.01).stay(3).coarsen(), says("no stay"));
  });
}

}  // namespace pliant::test::changed_meshes_suite

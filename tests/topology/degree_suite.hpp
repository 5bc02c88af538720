#pragma once

#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/mesh/with_types.hpp>

#include "topology/mixed_meshes.hpp"

// Bodies of linear and quadratic elements side by side: degrees are raised and lowered, beside refinement.
namespace pliant::test::degree_suite {

template <Element Linear, int Points, Element Quadratic, int MorePoints>
struct Pair {
  using Low = Formulation<Linear, Gauss<Points>, NeoHookean>;
  using High = Formulation<Quadratic, Gauss<MorePoints>, NeoHookean>;
  using LowSoft = Formulation<Linear, Gauss<Points>, SaintVenantKirchhoff>;
  using HighSoft = Formulation<Quadratic, Gauss<MorePoints>, SaintVenantKirchhoff>;
  static constexpr int dim = Linear::dim;
  template <class B>
  using body_type = Body<B, Mesh<Linear, Quadratic>, Low, HighSoft, LowSoft, High>;

  static Mesh<Linear, Quadratic> mesh() {
    return mesh::with_types<Linear, Quadratic>(distorted_mesh<Linear>(dim == 2 ? 4 : 3));
  }
  template <class B>
  static body_type<B> body(B const& backend) {
    return body_type<B>(backend, mesh(), soft, Group<Low>{}, Group<HighSoft>{}, Group<LowSoft>{},
                        Group<High>{});
  }
};
using All = List<Pair<Tri3, 1, Tri6, 2>, Pair<Quad4, 2, Quad9, 3>, Pair<Tet4, 1, Tet10, 2>,
                 Pair<Hex8, 2, Hex27, 3>, Pair<Hex8, 2, Hex20, 3>>;
using Few = List<Pair<Hex8, 2, Hex27, 3>>;
#if defined(__CUDACC__)  // all take too long to compile
template <class B>
using pairs_on = List<Pair<Tri3, 1, Tri6, 2>, Pair<Tet4, 1, Tet10, 2>, Pair<Hex8, 2, Hex27, 3>>;
#else
template <class B>
using pairs_on = std::conditional_t<std::same_as<B, MainBackend>, All, Few>;
#endif

/// Calls visit(B{}, pair): all pairs on the main backend of CPUs, one or three on the others.
template <class B, class Visit, class... P>
void on_each_pair(Visit const& visit, List<P...>) {
  (visit(B{}, P{}), ...);
}
template <class Bs, class Visit>
void on_pairs(Visit const& visit) {
  [&]<class... B>(std::tuple<B...> const*) {
    (on_each_pair<B>(visit, pairs_on<B>{}), ...);
  }(static_cast<Bs const*>(nullptr));
}

/// Raises, refines, lowers and merges at random.
template <class TheBody>
void change(TheBody& body, Random& random) {
  raise(body, some(body, TheBody::dim == 3 ? 6 : 8, random, 0), {.ring = 1});
  refine(body, some(body, TheBody::dim == 3 ? 4 : 3, random, -1), 3);
  raise(body, some(body, 6, random, 0));
  refine(body, some(body, TheBody::dim == 3 ? 16 : 5, random, -1), 3);
  lower(body, some(body, 4, random, 1));
  coarsen(body, some(body, 1 + random.below(1), random, -1));
  raise(body, some(body, 9, random, 0), {.ring = 1});
  refine(body, some(body, TheBody::dim == 3 ? 16 : 5, random, -1), 3);
  lower(body, some(body, 9, random, 1));
}
/// Back to the mesh of the beginning.
template <class TheBody>
void undo(TheBody& body) {
  do lower(body, all(body, 1));
  while (coarsen(body, all(body, -1)).merged > 0);
}

TEST_CASE("a mesh of mixed degrees passes the patch test", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    Random random(5);
    change(body, random);
    auto const& mesh = body.mesh();
    REQUIRE(elements<0>(body).size() > 0);
    REQUIRE(elements<1>(body).size() > 0);
    REQUIRE_FALSE(mesh.slaves.empty());
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));

    assign_all<typename P::Low>(body);
    assign_all<typename P::High>(body);
    check_patch<typename P::Low>(body);
  });
}

TEST_CASE("displacements of mixed degrees are continuous", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    for (unsigned seed : {3u, 4u}) {
      auto body = P::body(backend);
      Random random(seed);
      change(body, random);
      check_continuity(body, random);
    }
  });
}

TEST_CASE("raised elements are of their degree where all around them are", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    auto const report = raise(body, {{0}, {}});
    CHECK(report.raised == 1);
    CHECK(elements<1>(body).size() == 1);
    auto const& quadratic = elements<1>(body)[0];
    // Alone it gains nothing but what is inside of it and on the boundary.
    std::vector<Index> hanging;
    for (auto const& slave : body.mesh().slaves) hanging.push_back(slave.node);
    CHECK_FALSE(hanging.empty());
    std::size_t middles = 0;
    for (std::size_t a = 0; a < quadratic.size(); ++a)
      middles += std::ranges::count(hanging, quadratic[a]) > 0;
    CHECK(middles == hanging.size());

    auto with_ring = P::body(backend);
    auto const ring = raise(with_ring, {{0}, {}}, {.ring = 1});
    CHECK(ring.raised > 1);
    // None of the first one's own nodes hangs; it is the one with that place among the corners.
    auto const corners = elements<0>(P::body(backend))[0];
    std::size_t found = 0;
    for (auto const& nodes : elements<1>(with_ring)) {
      if (!std::ranges::equal(corners, std::span(nodes).first(corners.size()))) continue;
      ++found;
      for (auto const& slave : with_ring.mesh().slaves)
        CHECK(std::ranges::count(nodes, slave.node) == 0);
    }
    CHECK(found == 1);
    raise(with_ring, all(with_ring, 0));
    CHECK(elements<0>(with_ring).empty());
    CHECK(with_ring.mesh().slaves.empty());
  });
}

TEST_CASE("fields, momentum and energy are kept when degrees change, and the mesh comes back",
          "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    check_what_is_kept(
        body, [](auto& own, Random& random) { change(own, random); }, [](auto& own) { undo(own); });
  });
}

TEST_CASE("raised elements go to the group of their law", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    body.template assign<typename P::LowSoft>({1});
    raise(body, {{0, 1, 2}, {}});
    using Quadratic = typename P::High::element;
    CHECK(body.template groups_of<Quadratic>() == std::vector<Tag>{1, 0, 1});
    lower(body, {{}, {0, 1}});
    CHECK(body.template groups_of<Quadratic>() == std::vector<Tag>{1});
    using Linear = typename P::Low::element;
    auto const groups = body.template groups_of<Linear>();
    CHECK(groups[0] == 0);
    CHECK(groups[1] == 1);
  });
}

TEST_CASE("conditions, pressures and loads go along with degrees", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    constexpr int dim = P::dim;
    auto body = P::body(backend);
    auto const mesh = body.mesh();
    body.clamp(mesh.boundary("left"));
    body.press(mesh.boundary("right"), 0.25);
    auto const pressure = total(body.forces());
    raise(body, all(body, 0));
    auto const corners = mesh.boundary("left")[0].size();
    for (auto const& facet : body.mesh().boundary("left")) CHECK(facet.size() > corners);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(body.mesh().boundary("left")));
    CHECK(body.state().prescribed->pressures[0].facets == body.mesh().boundary("right"));
    auto const now = total(body.forces());
    for (std::size_t k = 0; k < dim; ++k) CHECK(now[k] == Approx(pressure[k]).margin(1e-13));

    Point<dim> load{};
    load[1] = 0.125;
    body.set_load(body.nodes() - 1, load);  // a node between corners
    lower(body, all(body, 1));
    CHECK(body.mesh().boundaries == mesh.boundaries);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(mesh.boundary("left")));
    Point<dim> sum{};
    for (auto const& own : nodal_loads(body))
      for (std::size_t k = 0; k < dim; ++k) sum[k] += own[k];
    for (std::size_t k = 0; k < dim; ++k) CHECK(sum[k] == Approx(load[k]).margin(1e-15));

    // A node that a condition names stays.
    raise(body, all(body, 0));
    std::vector<Index> const named{body.nodes() - 1};
    body.clamp(named);
    CHECK(lower(body, all(body, 1)).lowered > 0);
    REQUIRE(elements<1>(body).size() > 0);
    auto const& held = body.state().prescribed->conditions[1].nodes;
    REQUIRE(held.size() == 1);
    for (auto const& nodes : elements<1>(body)) CHECK(std::ranges::count(nodes, held[0]) == 1);
  });
}

TEST_CASE("quadratic meshes are lowered, and their nodes keep their numbers", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Low = Formulation<Hex8, Gauss<2>, NeoHookean>;
    using High = Formulation<Hex27, Gauss<3>, NeoHookean>;
    auto const mesh = mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex27>(3));
    Body body(backend, mesh, soft, Group<Low>{}, Group<High>{});
    auto const u = uniform(mesh.nodes, some_gradient<3>());
    body.set_displacements(u);
    double const energy = strain_energy(body);
    CHECK(lower(body, {{}, {0, 3, 4}}).lowered == 3);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(strain_energy(body) == Approx(energy).epsilon(1e-12));
    refine(body, {{1}, {2}});
    Random random(4);
    change(body, random);
    CHECK(difference(body.displacements(), uniform(body.mesh().nodes, some_gradient<3>())) < 1e-14);
    while (coarsen(body, all(body, -1)).merged > 0 || raise(body, all(body, 0)).raised > 0) {
    }
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(body.mesh().tables == mesh.tables);
    CHECK(body.mesh().boundaries == mesh.boundaries);
    CHECK(body.mesh().slaves.empty());
    CHECK(difference(body.displacements(), u) < 1e-14);
  });
}

TEST_CASE("a body of mixed degrees steps, saves and resumes", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    check_resuming([&] { return P::body(backend); },
                   [](auto& own, Random& random) { change(own, random); },
                   [](auto& own) { undo(own); });
  });
}

TEST_CASE("rules raise, refine, lower and merge by criteria", "[topology]") {
  on_pairs<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    auto const mesh = body.mesh();
    using Low = typename P::Low;
    using High = typename P::HighSoft;  // in which raised elements of Low are not
    using Raised = typename P::High;
    Adaptation adapt{when<Low>(StrainNorm{}).above(0.02).raise({.ring = 1}),
                     when<Raised>(StrainNorm{}).above(0.2).refine({.max_level = 1}),
                     when<Raised>(StrainNorm{}).below(0.01).lower(),
                     when<Raised>(StrainNorm{}).below(0.01).coarsen(),
                     when<Low>(StrainNorm{}).below(0.01).coarsen()};
    auto const stretch = [&](double amount) {
      FieldOf<P::dim> u;
      for (auto const& x : body.mesh().nodes) {
        auto& own = u.emplace_back();
        own[0] = amount * std::max(x[0] - 0.5, 0.0);
      }
      body.set_displacements(u);
    };
    stretch(0.001);
    adapt.now(body);
    CHECK(body.mesh().tables == mesh.tables);
    stretch(0.05);
    adapt.now(body);
    auto const raised = elements<1>(body).size();
    CHECK(raised > 0);
    CHECK(elements<0>(body).size() > 0);
    CHECK(elements<0>(body).size() + raised == elements<0>(P::body(backend)).size());
    CHECK(std::ranges::count(body.template groups_of<typename High::element>(), Tag{0}) == 0);
    stretch(0.5);
    adapt.now(body);
    CHECK(elements<1>(body).size() > raised);
    stretch(0);
    for (int k = 0; k < 4; ++k) adapt.now(body);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(body.mesh().tables == mesh.tables);
    std::string actions;
    for (auto const& entry : ledger(body)) actions += entry.action + ", ";
    CHECK(actions.find("raise") != std::string::npos);
    CHECK(actions.find("lower") != std::string::npos);
    CHECK_THROWS_WITH(when<Low>(StrainNorm{}).above(1).raise({.ring = -1}), says("ring of -1"));
    CHECK_THROWS_WITH(when<Raised>(StrainNorm{}).below(1).stay(2).lower(), says("no stay"));
  });
}

TEST_CASE("forces on a mesh of mixed degrees are the same on all backends", "[topology]") {
  on_pairs<std::tuple<MainBackend>>([]<class B, class P>(B const& backend, P) {
    check_agreement(
        backend, [](auto const& on) { return P::body(on); },
        [](auto& own, Random& random) { change(own, random); });
  });
}

TEST_CASE("raised elements take their values and what their points keep along", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Graded = Formulation<Quad4, Gauss<2>, PerElement<SaintVenantKirchhoff>::law>;
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<SaintVenantKirchhoff>::law>;
    using Plain = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
    using Graded9 = Formulation<Quad9, Gauss<3>, PerElement<SaintVenantKirchhoff>::law>;
    using Viscous9 = Formulation<Quad9, Gauss<3>, Prony<SaintVenantKirchhoff>::law>;
    auto const relaxing = [] {
      return typename Viscous::template law<double>{{3, 2}, {0.5}, {0.1}};
    };
    auto const mesh = mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(4));
    std::size_t const count = mesh.elements<Quad4>().size();
    Random random;
    std::vector<std::array<double, 2>> values(count);
    for (auto& v : values) v = {4 + random(), 2 + random()};
    auto const h = some_gradient<2>();
    {
      Body body{backend,
                mesh,
                soft,
                Group<Graded>{.values = values},
                Group<Viscous9>{relaxing()},
                Group<Viscous>{relaxing()},
                Group<Graded9>{}};
      std::vector<Index> every_other;
      for (std::size_t e = 0; e < count; e += 2) every_other.push_back(static_cast<Index>(e));
      body.template assign<Viscous>(every_other);
      body.clamp(boundary_nodes(mesh));
      // A linear field is exact on every mesh; it is kept for a while, so that branches relax in part.
      take_steps(body.parts(), 0.01, 1);
      body.set_displacements(uniform(mesh.nodes, h));
      commit_at(body.parts(), std::as_const(body.parts()).u());
      set_step_size(body.parts(), 0.05);
      auto const along = uniform(mesh.nodes, h);
      double const energy = strain_energy(body), work = inner(body.forces(), along);

      raise(body, {{0, 1, 4, 5}, {}});
      refine(body, {{1}, {0, 3}});
      lower(body, {{}, {0, 2}});

      CHECK(elements<1>(body).size() > 5);
      CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
      CHECK(inner(body.forces(), uniform(body.mesh().nodes, h)) == Approx(work).epsilon(1e-13));
      undo(body);
      CHECK(body.mesh().nodes == mesh.nodes);
      CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
      CHECK(inner(body.forces(), along) == Approx(work).epsilon(1e-13));
    }
    {  // What points keep of another law is nothing to them: they begin at rest.
      using Other = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
      typename Other::template law<double> const other{
          NeoHookean<double>::from(soft), {0.5}, {0.1}};
      Body body{backend, mesh, soft, Group<Other>{other}, Group<Viscous9>{relaxing()}};
      body.set_displacements(uniform(mesh.nodes, h));
      equilibrate(body.parts());
      raise(body, all(body, 0));
      set_step_size(body.parts(), 0.05);
      double const energy = strain_energy(body);
      auto const f = body.forces();
      equilibrate(body.parts());
      forget_forces(body.parts());
      CHECK(strain_energy(body) == Approx(energy).epsilon(1e-14));
      CHECK(difference(body.forces(), f) < 1e-14);
      CHECK(largest(f) > 0.01);
    }
    {  // There is nothing from which to take values.
      Body body{backend, mesh, soft, Group<Plain>{}, Group<Graded9>{}};
      CHECK_THROWS_WITH(raise(body, {{0}, {}}), says("values per element of type 1") &&
                                                    says("elements of type 0 have not"));
      CHECK(body.mesh().nodes == mesh.nodes);
    }
  });
}

TEST_CASE("degrees that cannot change are refused", "[topology][errors]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using P = Pair<Tri3, 1, Tri6, 2>;
    auto body = P::body(backend);
    raise(body, {{0}, {}});
    auto const nodes = body.mesh().nodes;
    CHECK_THROWS_WITH(raise(body, {{}, {0}}), says("Tri6 elements are of degree 2"));
    CHECK_THROWS_WITH(lower(body, {{0}, {}}), says("Tri3 elements are of degree 1"));
    CHECK_THROWS_WITH(raise(body, {{99}, {}}), says("no Tri3 element 99"));
    CHECK_THROWS_WITH(raise(body, {{0}}), says("1 element types, but the mesh has 2"));
    CHECK_THROWS_WITH(raise(body, {{0}, {}}, {.ring = -1}), says("a ring of -1"));
    set_mesh_limits(body, {.nodes = nodes.size() + 1});
    CHECK_THROWS_WITH(raise(body, {{0, 1, 2, 3}, {}}),
                      says("to raise the degree of") && says("the limit is"));
    CHECK(body.mesh().nodes == nodes);
    auto plain = body_of<typename P::Low>(backend, distorted_mesh<Tri3>(2));
    CHECK_THROWS_WITH(raise(plain, {{0}}), says("no element type of another degree"));
  });
}

}  // namespace pliant::test::degree_suite

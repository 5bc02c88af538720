#pragma once

#include <pliant/law/decorators/viscosity.hpp>

#include "support/formulations.hpp"

// What the compiler cannot see is one exception, whose message says what was wrong, where, and what to
// do; the body stays as it was.
namespace pliant::test::bad_input_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Solid = Formulation<Tet4, Gauss<1>, NeoHookean>;

inline Mesh<Quad4> sheet() { return mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}); }

TEST_CASE("an unsound mesh is refused", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto mesh = sheet();
    auto const make = [&] { (void)body_of<Rubber>(backend, mesh); };
    SECTION("no elements") {
      mesh.elements<Quad4>().clear();
      CHECK_THROWS_WITH(make(), says("no elements"));
      mesh.nodes.clear();
      CHECK_THROWS_AS(make(), Error);
    }
    SECTION("an inverted element") {
      auto& e = mesh.elements<Quad4>()[2];
      std::swap(e[1], e[3]);
      CHECK_THROWS_WITH(make(),
                        says("Quad4 element 2") && says("inverted") && says("counter-clockwise"));
    }
    SECTION("an element that is folded at one corner") {
      mesh.nodes[0] = {0.27, 0.27};  // the Jacobian is positive at each point of quadrature
      CHECK_THROWS_WITH(make(), says("Quad4 element 0") && says("inverted"));
    }
    SECTION("a degenerate element") {
      mesh.nodes[3] = mesh.nodes[0];
      mesh.nodes[4] = mesh.nodes[1];
      CHECK_THROWS_WITH(make(), says("Quad4 element 0") && says("degenerate"));
    }
    SECTION("an element of one point") {
      mesh.elements<Quad4>()[1] = {1, 1, 1, 1};
      CHECK_THROWS_WITH(make(), says("Quad4 element 1") && says("degenerate"));
    }
    SECTION("a node number out of range") {
      mesh.elements<Quad4>()[3][2] = 9;
      CHECK_THROWS_WITH(make(), says("Quad4 element 3") && says("node 9") && says("0 to 8"));
      mesh.elements<Quad4>()[3][2] = -1;
      CHECK_THROWS_WITH(make(), says("Quad4 element 3") && says("node -1"));
    }
    SECTION("a node that is nowhere") {
      mesh.nodes[7][1] = NAN;
      CHECK_THROWS_WITH(make(), says("node 7") && says("not finite"));
      mesh.nodes[7][1] = INFINITY;
      CHECK_THROWS_WITH(make(), says("node 7") && says("not finite"));
    }
  });
}

TEST_CASE("an unsound tetrahedron is refused", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto mesh = regular_mesh<Tet4>(2);
    std::swap(mesh.elements<Tet4>()[5][0], mesh.elements<Tet4>()[5][1]);
    CHECK_THROWS_WITH(body_of<Solid>(backend, mesh), says("Tet4 element 5") && says("inverted"));
    Mesh<Tet4> flat;
    flat.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    flat.elements<Tet4>() = {{0, 1, 2, 3}};
    CHECK_THROWS_WITH(body_of<Solid>(backend, flat), says("Tet4 element 0") && says("degenerate"));
  });
}

TEST_CASE("a tiny mesh and a mesh far away are sound", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto mesh = sheet();
    for (auto& x : mesh.nodes) x = {1e-7 * x[0] + 1, 1e-7 * x[1] + 1};
    CHECK_NOTHROW(body_of<Rubber>(backend, mesh));
    mesh = sheet();
    for (auto& x : mesh.nodes) x = {x[0] + 1e5, x[1] - 1e5};
    CHECK_NOTHROW(body_of<Rubber>(backend, mesh));
  });
}

TEST_CASE("an impossible material is refused", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const make = [&](Elastic const& m) { (void)body_of<Rubber>(backend, sheet(), m); };
    for (double young : {0.0, -1.0, double{NAN}, double{INFINITY}})
      CHECK_THROWS_WITH(make({young, 0.3, 1}), says("Young's modulus") && says("positive"));
    for (double poisson : {-1.0, 0.5, 0.7, double{NAN}})
      CHECK_THROWS_WITH(make({1, poisson, 1}), says("Poisson's ratio") && says("(-1, 0.5)"));
    for (double density : {0.0, -1.0, double{NAN}, double{INFINITY}})
      CHECK_THROWS_WITH(make({1, 0.3, density}), says("density") && says("positive"));
    CHECK_NOTHROW(make({1, -0.5, 1}));
    CHECK_NOTHROW(make({1, 0, 1}));
  });
}

TEST_CASE("a law's own parameters must be finite", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    CHECK_THROWS_WITH((Body{backend, sheet(), soft, Group<Rubber>{NeoHookean<double>{3, NAN}}}),
                      says("parameter 1 of the law given to the group on Quad4 is not finite"));
  });
}

template <template <class> class L>
using On = Formulation<Quad4, Gauss<2>, L>;

TEST_CASE("a law's own parameters must be possible", "[body]") {
  MainBackend const backend;
  // One body of many groups, since each body takes long to compile.
  Prony<NeoHookean, 2>::law<double> const two_times{{3, 2}, {1, 1}, {1, 2}};
  Prony<Fung>::law<double> const one_time{{3, 2, 1}, {1}, {1}};
  std::tuple const possible{
      Group<On<Fung>>{},
      Group<On<Gent>>{},
      Group<On<ArrudaBoyce>>{},
      Group<On<Ogden>>{},
      Group<On<Prony<NeoHookean, 2>::law>>{two_times},
      Group<On<Prony<Fung>::law>>{one_time},
      Group<On<KelvinVoigt<Fung>::law>>{KelvinVoigt<Fung>::law<double>{{3, 2, 1}, 1}},
      Group<On<PlaneStress<Fung>::law>>{}};
  auto const with = [&]<template <class> class L>(L<double> const& law) {
    auto groups = possible;
    std::get<Group<On<L>>>(groups).law = law;
    std::apply([&](auto const&... group) { Body{backend, sheet(), soft, group...}; }, groups);
  };
  std::string const group = "body: the law given to the group on Quad4 is impossible: ";
  CHECK_THROWS_WITH(with(Fung<double>{3, 2, 0}),
                    group + "Fung's exponent is 0; it must be positive");
  CHECK_THROWS_WITH(with(Fung<double>{3, 0, 1}), says("Fung's mu is 0"));
  CHECK_THROWS_WITH(with(Gent<double>{2, 0, 5}), says("Gent's limit is 0; it must be positive"));
  CHECK_THROWS_WITH(with(ArrudaBoyce<double>{2, 0, 5}), says("locking stretch is 0"));
  CHECK_THROWS_WITH(with(Ogden<double>{{2, 0, 0}, {2, 1, 0}, 5}), says("an alpha of Ogden is 0"));
  CHECK_THROWS_WITH(with(Prony<NeoHookean, 2>::law<double>{{3, 2}, {1, 1}, {1, -2}}),
                    says("a relaxation time of Prony is -2; it must be positive"));
  CHECK_THROWS_WITH(with(Prony<Fung>::law<double>{{3, 2, 0}, {1}, {1}}), says("Fung's exponent"));
  CHECK_THROWS_WITH(with(KelvinVoigt<Fung>::law<double>{{3, 2, 0}, 1}), says("Fung's exponent"));
  CHECK_THROWS_WITH(with(PlaneStress<Fung>::law<double>{{{3, 2, 0}}}), says("Fung's exponent"));
  CHECK_NOTHROW(with(Prony<Fung>::law<double>{{3, 2, 1}, {1}, {1}}));

  using Artery = On<HolzapfelGasserOgden>;
  HolzapfelGasserOgden<double> const artery{.mu = 2, .k1 = 1, .k2 = 0, .dispersion = 0, .bulk = 5};
  CHECK_THROWS_WITH((Body{backend, sheet(), soft, Group<Artery>{artery, {{1, 0, 0, 0, 1, 0}}}}),
                    says("Holzapfel-Gasser-Ogden's k2 is 0"));
  using Graded = On<PerElement<Fung>::law>;
  CHECK_THROWS_WITH((Body{backend, sheet(), soft,
                          Group<Graded>{.values = {{3, 2, 1}, {3, 2, 1}, {3, 2, 0}, {3, 2, 1}}}}),
                    says("body: the law of Quad4 element 2 is impossible: Fung's exponent is 0"));
}

/// Everything of a body that a refused call must leave alone.
template <class TheBody>
auto all_of(TheBody& body) {
  return std::tuple{body.displacements(),
                    body.velocities(),
                    body.forces(),
                    body.template groups_of<Quad4>(),
                    body.state().gravity,
                    body.state().damping,
                    nodal_loads(body),
                    body.state().prescribed->conditions.size(),
                    body.time(),
                    body.steps(),
                    body.parts().layout.mass_list()};
}

TEST_CASE("a call that is refused leaves the body as it was", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = sheet();
    Body body{backend, mesh, soft, Group<Rubber>{}, Group<Formulation<Quad4, Gauss<2>, Hooke>>{}};
    body.set_gravity({0, -1});
    body.set_load(2, {0.1, 0});
    body.clamp(mesh.boundary("left"));
    body.set_velocities(Random(1).field<2>(9, 0.1));
    CentralDifference step{{.step = 1e-3}};
    step(body, 3);
    auto const before = all_of(body);

    CHECK_THROWS_WITH(body.set_displacements(FieldOf<2>(8)), says("8 nodes") && says("has 9"));
    CHECK_THROWS_WITH(body.set_velocities(FieldOf<2>(10)), says("10 nodes") && says("has 9"));
    FieldOf<2> broken(9);
    broken[4][1] = NAN;
    CHECK_THROWS_WITH(body.set_displacements(broken), says("node 4") && says("not finite"));
    broken[4][1] = -INFINITY;
    CHECK_THROWS_WITH(body.set_velocities(broken), says("node 4") && says("not finite"));
    CHECK_THROWS_WITH(body.set_load(9, {1, 1}), says("node 9") && says("0 to 8"));
    CHECK_THROWS_WITH(body.set_load(-1, {1, 1}), says("node -1"));
    CHECK_THROWS_WITH(body.set_load(3, {NAN, 1}), says("node 3") && says("not finite"));
    CHECK_THROWS_WITH(body.set_damping(-1), says("-1") && says("not negative"));
    CHECK_THROWS_AS(body.set_damping(NAN), Error);
    CHECK_THROWS_AS(body.set_damping(INFINITY), Error);
    CHECK_THROWS_WITH(body.set_gravity({0, NAN}), says("gravity"));
    CHECK_THROWS_WITH(body.clamp(std::vector<Index>{1, 9}), says("node 9") && says("0 to 8"));
    CHECK_THROWS_WITH(body.hold(std::vector<Index>{-2}, 1), says("node -2"));
    CHECK_THROWS_AS(body.clamp(std::vector<Facet<2>>{{3, 12}}), Error);
    CHECK_THROWS_AS(body.drive(std::vector<Index>{99}, [](double) { return Point<2>{}; }), Error);
    CHECK_THROWS_WITH(body.drive(std::vector<Index>{5},
                                 [](double) {
                                   return Point<2>{NAN, 0};
                                 }),
                      says("node 5") && says("finite"));
    CHECK_THROWS_WITH((body.template assign<Formulation<Quad4, Gauss<2>, Hooke>>({0, 4})),
                      says("Quad4 element 4") && says("0 to 3"));
    CHECK_THROWS_AS(body.template assign<Rubber>({-1}), Error);
    CHECK_THROWS_WITH(body.mesh().boundary("lid"), says("lid"));

    CHECK((all_of(body) == before));
  });
}

/// Like NeoHookean, with λ and μ of each element.
using Graded = Formulation<Quad4, Gauss<2>, PerElement<NeoHookean>::template law>;

TEST_CASE("numbers that single precision cannot hold are refused", "[body][errors]") {
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    auto const mesh = sheet();
    auto body = body_of<Rubber>(backend, mesh);
    body.set_velocities(Random(1).field<2>(9, 0.1));
    CentralDifference step{{.step = 1e-3}};
    step(body, 3);
    auto const before = all_of(body);
    FieldOf<2> big(9);
    big[4][1] = 1e39;
    std::string const large = " is too large for single precision";

    CHECK_THROWS_WITH(body.set_loads(big), says("body.set_loads: the value at node 4" + large));
    CHECK_THROWS_WITH(body.set_load(3, {0, -1e39}), says("set_load: the force at node 3" + large));
    CHECK_THROWS_WITH(body.set_velocities(big),
                      says("set_velocities: the value at node 4" + large));
    CHECK_THROWS_WITH(body.set_displacements(big), says("set_displacements: the value at node 4"));
    CHECK_THROWS_WITH(body.set_gravity({0, -1e39}), says("set_gravity: -1e+39" + large));
    CHECK_THROWS_WITH(body.set_damping(1e39), says("set_damping: 1e+39" + large));
    CHECK_THROWS_WITH(body.press(mesh.boundary("left"), 1e39), says("single precision"));
    CHECK_THROWS_WITH(body.drive(std::vector<Index>{5},
                                 [](double) {
                                   return Point<2>{1e39, 0};
                                 }),
                      says("node 5") && says("single precision"));
    CHECK((all_of(body) == before));

    CHECK_THROWS_WITH(body_of<Rubber>(backend, mesh, {1e39, 0.3, 1}), says("32 bits cannot hold"));
    for (double density : {1e39, 1e-46})
      CHECK_THROWS_WITH(body_of<Rubber>(backend, mesh, {1, 0.3, density}),
                        says("32 bits cannot hold the mass of a node"));
    auto vast = mesh;
    for (auto& x : vast.nodes) x = {1e39 * x[0], 1e39 * x[1]};
    CHECK_THROWS_WITH(body_of<Rubber>(backend, vast), says("32 bits cannot hold"));
    CHECK_THROWS_WITH(
        (Body{backend, mesh, soft, Group<Graded>{.values = {{3, 2}, {3, 2}, {1e39, 2}, {3, 2}}}}),
        says("value 0 of Quad4 element 2 is too large for single precision"));
  });
}

TEST_CASE("double precision takes what single precision refuses", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, sheet());
    CHECK_NOTHROW(body.set_load(3, {0, -1e39}));
    CHECK_NOTHROW(body.set_gravity({0, -1e39}));
    CHECK_NOTHROW(body_of<Rubber>(backend, sheet(), {1e39, 0.3, 1}));
    CHECK_NOTHROW((Body{backend, sheet(), soft, Group<Graded>{.values = {{1e39, 1e39}}}}));
  });
}

TEST_CASE("central differences refuse options that are no numbers or negative", "[body][errors]") {
  for (double bad : {double{NAN}, -1e-3}) {
    CHECK_THROWS_WITH(CentralDifference({.step = bad}), says("step"));
    CHECK_THROWS_AS(CentralDifference({.safety = bad}), Error);
    CHECK_THROWS_AS(CentralDifference({.energy_growth = bad}), Error);
    CHECK_THROWS_AS(CentralDifference({.energy_drift = bad}), Error);
  }
  CHECK_THROWS_AS(CentralDifference({.step = INFINITY}), Error);
  CHECK_THROWS_AS(CentralDifference({.safety = 1.5}), Error);
  CHECK_THROWS_AS(CentralDifference({.check_interval = 0}), Error);
  auto body = body_of<Rubber>(MainBackend{}, sheet());
  CentralDifference step;
  CHECK_THROWS_WITH(step(body, -1), says("-1 steps"));
  CHECK(body.steps() == 0);
}

TEST_CASE("a motion that ends in nowhere stops the body with a message", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, sheet());
    body.drive(std::vector<Index>{0}, [](double t) { return Point<2>{std::sqrt(0.01 - t), 0}; });
    CentralDifference step{{.step = 1e-3}};
    CHECK_THROWS_WITH(step(body, 100), says("node 0") && says("finite"));
    CHECK(std::isfinite(largest(body.displacements())));
  });
}

TEST_CASE("a body that has no stable step says so", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = sheet();
    auto body = body_of<Rubber>(backend, mesh);
    std::vector<Index> all{0, 1, 2, 3, 4, 5, 6, 7, 8};
    body.clamp(all);
    CHECK_THROWS_WITH(stable_step(body), says("every node is held"));
    auto inverted = body_of<Rubber>(backend, mesh);
    FieldOf<2> u(9);
    u[4] = {0.9, 0.9};
    inverted.set_displacements(u);
    CHECK_THROWS_WITH(stable_step(inverted), says("not finite"));
  });
}

TEST_CASE("laws go on with their time step when there is no stable one", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Quad4, Gauss<2>, KelvinVoigt<SaintVenantKirchhoff>::template law>;
    typename F::template law<double> const law{{3, 2}, 0.5};
    auto const mesh = sheet();
    Body body{backend, mesh, soft, Group<F>{law}};
    CentralDifference step{{.step = 1e-3}};
    step(body, 3);
    body.clamp(nodes_of(mesh::outer_sides(mesh)));
    body.clamp(std::vector<Index>{4});

    CHECK_THROWS_AS(stable_step(body), Error);

    CHECK(body.state().step_size == 1e-3);
  });
}

}  // namespace pliant::test::bad_input_suite

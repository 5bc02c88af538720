#pragma once

#include <pliant/law/decorators/viscosity.hpp>

#include "support/flat.hpp"
#include "support/formulations.hpp"

// A simulator that owns its state hands in pointers to its own arrays, in its own order and stride.
namespace pliant::test::embedding_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

TEST_CASE("add_force, add_tangent_product and add_lumped_mass add and never overwrite", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = body_of<Rubber>(backend, mesh);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const du = Random(2).field<2>(mesh.nodes.size(), 1.0);
    auto const before = Random(3).field<2>(mesh.nodes.size(), 1.0);
    auto const at = upload(backend, flat<T>(u)), along = upload(backend, flat<T>(du));
    auto forces = upload(backend, flat<T>(before)), changes = upload(backend, flat<T>(before));
    auto masses = upload(backend, std::vector<T>(mesh.nodes.size(), T(7)));

    body.add_force(at.data(), forces.data());
    body.add_force(at.data(), forces.data());
    body.add_tangent_product(at.data(), along.data(), changes.data(), 0.5);
    body.add_lumped_mass(masses.data());

    double const tolerance = 64 * double{std::numeric_limits<T>::epsilon()};
    auto const f = forces_at(body, u), df = tangent_product(body, u, du);
    CHECK(difference(per_node<2>(download<T>(forces)), plus(before, 2, f)) < tolerance);
    CHECK(difference(per_node<2>(download<T>(changes)), plus(before, 0.5, df)) <
          tolerance * largest(df));
    auto const summed = download<T>(masses);
    for (std::size_t i = 0; i < summed.size(); ++i)
      CHECK(static_cast<double>(summed[i]) ==
            Approx(7 + body.parts().layout.mass_list()[i]).epsilon(tolerance));
  });
}

TEST_CASE("a stride leaves what lies between the nodes alone", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = body_of<Rubber>(backend, mesh);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const du = Random(2).field<2>(mesh.nodes.size(), 1.0);
    int const stride = 5;
    auto const at = upload(backend, flat<T>(u, stride, NAN));
    auto const along = upload(backend, flat<T>(du, stride, NAN));
    auto forces = upload(backend, flat<T>(FieldOf<2>(u.size()), stride, 3));
    auto changes = upload(backend, flat<T>(FieldOf<2>(u.size()), stride, 3));

    body.add_force(at.data(), forces.data(), stride);
    body.add_tangent_product(at.data(), along.data(), changes.data(), 1, stride);
    double const energy = body.energy(at.data(), stride);

    auto const padded = download<T>(forces), padded_changes = download<T>(changes);
    CHECK(difference(per_node<2>(padded, stride), forces_at(body, u)) == 0);
    CHECK(difference(per_node<2>(padded_changes, stride), tangent_product(body, u, du)) == 0);
    CHECK(energy == strain_energy(body));
    for (std::size_t i = 0; i < padded.size(); ++i)
      if (i % stride >= 2) {
        REQUIRE(padded[i] == T(3));
        REQUIRE(padded_changes[i] == T(3));
      }
  });
}

TEST_CASE("strides that would mix up the nodes are refused", "[body][errors]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(3);
    auto body = body_of<Rubber>(backend, mesh);
    auto const u = upload(backend, std::vector<double>(2 * mesh.nodes.size(), 0.0));
    auto f = upload(backend, std::vector<double>(2 * mesh.nodes.size(), 3.0));

    CHECK_THROWS_WITH(body.add_force(u.data(), f.data(), 1),
                      says("body.add_force: stride 1 is smaller than the dimension 2"));
    CHECK_THROWS_WITH(body.add_tangent_product(u.data(), u.data(), f.data(), 1, -2),
                      says("body.add_tangent_product: stride -2"));
    CHECK_THROWS_WITH(body.energy(u.data(), 0), says("body.energy: stride 0"));

    CHECK(download<double>(f) == std::vector<double>(2 * mesh.nodes.size(), 3.0));
  });
}

TEST_CASE("the user's numbering does not matter", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const plain = shaken(regular_mesh<Quad4>(6), 0.03);
    auto const mixed = shuffled(plain, 5);
    auto first = body_of<Rubber>(backend, plain), second = body_of<Rubber>(backend, mixed);
    auto const state = [](Mesh<Quad4> const& mesh) {
      FieldOf<2> u(mesh.nodes.size());
      for (std::size_t i = 0; i < u.size(); ++i)
        u[i] = {0.1 * std::sin(7 * mesh.nodes[i][0] + mesh.nodes[i][1]),
                0.1 * std::cos(5 * mesh.nodes[i][0] * mesh.nodes[i][1])};
      return u;
    };

    auto const f = forces_at(first, state(plain)), g = forces_at(second, state(mixed));

    double const tolerance = 64 * double{std::numeric_limits<T>::epsilon()} * largest(f);
    std::map<Point<2>, std::size_t> found;
    for (std::size_t i = 0; i < plain.nodes.size(); ++i) found[plain.nodes[i]] = i;
    for (std::size_t i = 0; i < mixed.nodes.size(); ++i) {
      std::size_t const twin = found.at(mixed.nodes[i]);
      for (std::size_t k = 0; k < 2; ++k) CHECK(std::abs(f[twin][k] - g[i][k]) < tolerance);
      CHECK(first.parts().layout.mass_list()[twin] ==
            Approx(second.parts().layout.mass_list()[i]).epsilon(1e-14));
    }
    CHECK(strain_energy(first) == Approx(strain_energy(second)).epsilon(tolerance));
  });
}

TEST_CASE("a mesh of plain arrays makes a body", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Mesh<Tri3> mesh;
    mesh.nodes = {{0, 0}, {2, 0}, {0, 1}};
    mesh.elements<Tri3>() = {{0, 1, 2}};
    Body body{backend, mesh, soft, Group<Formulation<Tri3, Gauss<1>, Hooke>>{}};
    auto const u = upload(backend, std::vector<T>{0, 0, T(0.25), 0, 0, 0});  // e_xx = 1/8
    auto f = upload(backend, std::vector<T>(6, T(0)));

    body.add_force(u.data(), f.data());

    // σ_xx = (λ + 2μ)/8 = 7/8 and σ_yy = λ/8 = 3/8 on half the edges' length.
    auto const forces = download<T>(f);
    double const tolerance = 8 * double{std::numeric_limits<T>::epsilon()};
    double const expected[] = {7.0 / 16, 6.0 / 16, -7.0 / 16, 0, 0, -6.0 / 16};
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(static_cast<double>(forces[i]) == Approx(expected[i]).margin(tolerance));
    CHECK(body.energy(u.data()) == Approx(7.0 / 128).epsilon(tolerance));
    for (double m : body.parts().layout.mass_list()) CHECK(m == Approx(0.5).epsilon(1e-15));
  });
}

TEST_CASE("internal variables that are committed by hand act at once", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
    auto const mesh = distorted_mesh<Quad4>(5);
    Body body{backend, mesh, soft,
              Group<Viscous>{typename Viscous::template law<double>{
                  NeoHookean<double>::from(soft), {0.5}, {0.05}}}};
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step{{.step = 1e-3}};
    step(body, 20);
    auto const before = body.forces();
    auto const u = upload(backend, flat<double>(Random(2).field<2>(mesh.nodes.size(), 0.05)));
    REQUIRE(body.parts().has_checkpoint);

    body.commit(u.data(), 1e-3);

    auto const after = body.forces();
    forget_forces(body.parts());
    CHECK(difference(after, body.forces()) <= 1e-12 * largest(after));
    CHECK(difference(after, before) > 1e-3 * largest(before));
    CHECK_FALSE(body.parts().has_checkpoint);
  });
}

TEST_CASE("a step that is missing is told from one that is negative", "[body][errors]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
    auto const mesh = distorted_mesh<Quad4>(3);
    auto body = body_of<Rubber>(backend, mesh);
    Body viscous{backend, mesh, soft,
                 Group<Viscous>{typename Viscous::template law<double>{
                     NeoHookean<double>::from(soft), {0.5}, {0.05}}}};
    auto u = zeros<double>(backend, 2 * mesh.nodes.size()), f = zeros<double>(backend, u.size());

    CHECK_THROWS_WITH(body.add_force(u.data(), f.data(), 2, -3),
                      says("a step of -3 s") && !says("internal variables"));
    CHECK_THROWS_WITH(viscous.add_force(u.data(), f.data()),
                      says("internal variables") && !says("-1"));
    CHECK_NOTHROW(body.add_force(u.data(), f.data()));
  });
}

}  // namespace pliant::test::embedding_suite

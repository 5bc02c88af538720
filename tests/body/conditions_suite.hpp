#pragma once

#include "support/formulations.hpp"

namespace pliant::test::conditions_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
constexpr DirectionMask along_x = 1, along_y = 2;

/// A strip of 8 x 2 cells, 1 m by 0.25 m.
inline Mesh<Quad4> strip() { return mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}); }

TEST_CASE("clamped nodes stay where they are and the others move", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = shuffled(strip());
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0.3, -1});
    CentralDifference step{{.step = 2e-3}};

    step(body, 50);

    auto const clamped = nodes_of(mesh.boundary("left"));
    auto const u = body.displacements(), v = body.velocities();
    for (Index i = 0; i < body.nodes(); ++i) {
      auto const n = static_cast<std::size_t>(i);
      bool const moves = u[n][0] != 0 && u[n][1] != 0 && v[n][0] != 0 && v[n][1] != 0;
      bool const rests = u[n] == Point<2>{} && v[n] == Point<2>{};
      CHECK((std::ranges::binary_search(clamped, i) ? rests : moves));
    }
  });
}

TEST_CASE("a direction is held alone", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    auto const left = nodes_of(mesh.boundary("left"));
    body.hold(mesh.boundary("left"), along_x);
    body.hold(left, along_x);  // twice is once
    body.hold(std::vector<Index>{left[0]}, along_y);
    body.set_gravity({0.3, -1});
    CentralDifference step{{.step = 2e-3}};

    step(body, 50);

    auto const u = body.displacements();
    for (Index i : left) {
      CHECK(u[static_cast<std::size_t>(i)][0] == 0);
      CHECK((u[static_cast<std::size_t>(i)][1] == 0) == (i == left[0]));
    }
  });
}

TEST_CASE("nodes are held where they are and lose their speed", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    auto const left = nodes_of(mesh.boundary("left"));
    FieldOf<2> const everywhere(mesh.nodes.size(), {0.25, 0.5}), fast(mesh.nodes.size(), {1, 2});
    body.set_displacements(everywhere);
    body.set_velocities(fast);

    body.hold(mesh.boundary("left"), along_x);

    auto const held = body.velocities();
    for (Index i : left) CHECK(held[static_cast<std::size_t>(i)] == Point<2>{0, 2});
    CentralDifference step{{.step = 1e-3}};
    step(body, 5);
    for (Index i : left) {
      CHECK(body.displacements()[static_cast<std::size_t>(i)][0] == 0.25);
      CHECK(body.velocities()[static_cast<std::size_t>(i)][0] == 0);
      CHECK(body.velocities()[static_cast<std::size_t>(i)][1] != 0);
    }
    body.set_velocities(fast);
    for (Index i : left) CHECK(body.velocities()[static_cast<std::size_t>(i)] == Point<2>{0, 2});
  });
}

TEST_CASE("driven nodes follow their motion", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    auto const motion = [](double t) -> Point<2> {
      return {0.1 + 0.02 * std::sin(30 * t), -0.5 * t * t};
    };
    CentralDifference step{{.step = 1e-3}};
    body.drive(mesh.boundary("right"), motion);
    auto const right = nodes_of(mesh.boundary("right"));
    CHECK(body.displacements()[static_cast<std::size_t>(right[0])][0] ==
          static_cast<double>(T(0.1)));

    for (int k = 1; k <= 20; ++k) {
      step(body);
      auto const u = body.displacements();
      Point<2> const to = motion(body.time());
      for (Index i : right)
        for (std::size_t j = 0; j < 2; ++j)
          REQUIRE(u[static_cast<std::size_t>(i)][j] == static_cast<double>(static_cast<T>(to[j])));
    }

    // The velocity is that of the last step's middle: t v' off.
    for (Index i : right) {
      auto const v = body.velocities()[static_cast<std::size_t>(i)];
      double const middle = body.time() - 5e-4;
      double const rounding = 8 * double{std::numeric_limits<T>::epsilon()};
      CHECK(v[0] == Approx(0.6 * std::cos(30 * middle)).epsilon(1e-3));
      CHECK(v[1] == Approx(-middle).epsilon(rounding).margin(rounding));
    }
    CHECK(strain_energy(body) > 0);
  });
}

TEST_CASE("a strip that is drawn out slowly takes the confined stretch", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    std::vector<Index> all(mesh.nodes.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    body.hold(all, along_y);
    body.hold(mesh.boundary("left"), along_x);
    body.drive(mesh.boundary("right"),
               [](double t) -> Point<2> {
                 double const s = std::min(t, 1.0);
                 return {0.2 * s * s * (3 - 2 * s), 0};
               },
               {.directions = along_x});
    body.set_damping(6);
    CentralDifference step{};

    while (body.time() < 8) step(body);

    // What is left of the motion is below e^(−ζ t) with ζ = 3/s for 7 s.
    auto const u = body.displacements();
    for (std::size_t i = 0; i < u.size(); ++i)
      CHECK(u[i][0] == Approx(0.2 * mesh.nodes[i][0]).margin(1e-8));
    double pull = 0;
    auto const f = body.forces();
    for (Index i : nodes_of(mesh.boundary("right"))) pull -= f[static_cast<std::size_t>(i)][0];
    CHECK(pull == Approx(0.25 * 1.18913722532).margin(1e-7));  // REFERENCES, section 6
  });
}

TEST_CASE("a load accelerates its node by load over mass", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = shuffled(strip());
    auto body = body_of<Rubber>(backend, mesh);
    double const dt = 1.0 / 1024;
    CentralDifference step{{.step = dt}};
    body.set_load(5, {3, -1});
    body.set_load(11, {1, 1});
    body.set_load(11, {0, 2});  // replaces

    step(body);

    double const epsilon = 4 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const u = body.displacements();
    for (std::size_t i = 0; i < u.size(); ++i) {
      Point<2> const load = i == 5 ? Point<2>{3, -1} : i == 11 ? Point<2>{0, 2} : Point<2>{};
      for (std::size_t k = 0; k < 2; ++k)
        CHECK(u[i][k] ==
              Approx(dt * dt / 2 * load[k] / body.parts().layout.mass_list()[i]).epsilon(epsilon));
    }
  });
}

TEST_CASE("free fall is exact", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = body_of<Rubber>(backend, mesh);
    body.set_gravity({0.5, -8});
    double const dt = 1.0 / 64;
    CentralDifference step{{.step = dt}};

    step(body, 64);

    double const epsilon = 64 * double{std::numeric_limits<T>::epsilon()};
    for (auto const& u : body.displacements()) {
      CHECK(u[0] == Approx(0.25).epsilon(epsilon));
      CHECK(u[1] == Approx(-4).epsilon(epsilon));
    }
    for (auto const& v : body.velocities()) CHECK(v[1] == Approx(-8).epsilon(epsilon));
  });
}

}  // namespace pliant::test::conditions_suite

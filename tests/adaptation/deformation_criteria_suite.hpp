#pragma once

#include <numbers>

#include "adaptation/criteria.hpp"

namespace pliant::test::deformation_criteria_suite {

TEST_CASE("R_L and R_A of a homogeneous state are those of its stretch", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    constexpr int dim = E::dim;
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const mesh = distorted_mesh<E>(4);
    Random random(3);
    for (double size : {1e-4, 0.3}) {
      Tensor<double, dim> const h = random.tensor<dim>(size);
      auto f = h;
      for (int i = 0; i < dim; ++i) f(i, i) += 1;
      auto const u = uniform(mesh.nodes, h);

      auto const r_l = values_at<E>(backend, mesh, u, EdgeLengthRatio{});
      auto const r_a = values_at<E>(backend, mesh, u, AreaRatio{});

      auto const& elements = mesh.template elements<E>();
      for (std::size_t e = 0; e < elements.size(); ++e) {
        double expected = 0;
        for (auto const& [a, b] : E::edges()) {
          double at_rest = 0, now = 0;
          auto const &x = mesh.nodes[static_cast<std::size_t>(elements[e][std::size_t(a)])],
                     &y = mesh.nodes[static_cast<std::size_t>(elements[e][std::size_t(b)])];
          for (int i = 0; i < dim; ++i) {
            double component = 0;
            for (int k = 0; k < dim; ++k)
              component += f(i, k) * (y[std::size_t(k)] - x[std::size_t(k)]);
            now += component * component;
            at_rest +=
                (y[std::size_t(i)] - x[std::size_t(i)]) * (y[std::size_t(i)] - x[std::size_t(i)]);
          }
          expected = std::max(expected, std::abs(std::sqrt(now / at_rest) - 1));
        }
        // Displacements are rounded to ε/2, and compared over edges of 0.1 and more.
        CHECK(r_l[e] == Approx(expected).epsilon(1e-12).margin(16 * epsilon * size + 1e-15));
        CHECK(r_a[e] == Approx(std::abs(determinant(f) - 1))
                            .epsilon(1e-11)
                            .margin(32 * epsilon * size + 1e-15));
      }
    }
  });
}

TEST_CASE("stretches and shears of a unit cell have the printed criteria", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    double const tolerance = 8 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const near = [&](double x) { return Approx(x).margin(tolerance); };
    auto const square = mesh::rectangle({.size = {1, 1}, .cells = {1, 1}});
    auto const both = [&](auto const& mesh, auto element, auto const& h) {
      using E = decltype(element);
      auto const u = uniform(mesh.nodes, h);
      return std::pair{values_at<E>(backend, mesh, u, EdgeLengthRatio{}),
                       values_at<E>(backend, mesh, u, AreaRatio{})};
    };
    {
      auto const [r_l, r_a] = both(square, Quad4{}, Tensor<double, 2>{{{0.2, 0}, {0, -0.3}}});
      CHECK(r_l[0] == near(0.3));
      CHECK(r_a[0] == near(0.16));
    }
    {
      auto const [r_l, r_a] = both(square, Quad4{}, Tensor<double, 2>{{{0, 0.75}, {0, 0}}});
      CHECK(r_l[0] == near(0.25));  // √(1 + 0.75²) = 1.25
      CHECK(r_a[0] == near(0));
    }
    {
      auto const triangles = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {1, 1}});
      auto const [r_l, r_a] = both(triangles, Tri3{}, Tensor<double, 2>{{{0, 0.75}, {0, 0}}});
      // The diagonal (1, 1) becomes (1.75, 1).
      CHECK(r_l[0] == near(std::sqrt((1.75 * 1.75 + 1) / 2) - 1));
      CHECK(r_a[0] == near(0));
    }
    {
      auto const cube = mesh::box({.size = {1, 1, 1}, .cells = {1, 1, 1}});
      auto const [r_l, r_a] =
          both(cube, Hex8{}, Tensor<double, 3>{{{0.2, 0, 0}, {0, 0.1, 0}, {0, 0, -0.5}}});
      CHECK(r_l[0] == near(0.5));
      CHECK(r_a[0] == near(0.34));
    }
  });
}

TEST_CASE("R_A compares volumes where the state is not homogeneous too", "[adaptation]") {
  on_each_element<MainAlone>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(4);
    auto const u = Random(3).field<E::dim>(mesh.nodes.size(), 0.05);
    auto moved = mesh;
    moved.nodes = plus(mesh.nodes, 1, u);

    auto const r_a = values_at<E>(backend, mesh, u, AreaRatio{});

    for (std::size_t e = 0; e < r_a.size(); ++e) {
      auto const& element = mesh.template elements<E>()[e];
      double const before = volume<E, Gauss<3>>(nodal(mesh, element)),
                   after = volume<E, Gauss<3>>(nodal(moved, element));
      CHECK(r_a[e] == Approx(std::abs(after / before - 1)).margin(1e-13));
    }
  });
}

TEST_CASE("the motion without strain for Hooke's law grows by the square of the tangent",
          "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const mesh = distorted_mesh<E>(3);
    for (double degrees : {1.0, 5.0, 20.0, 45.0, 60.0}) {
      double const w = std::tan(degrees * std::numbers::pi / 180);
      auto spin = Tensor<double, E::dim>::zero();
      spin(0, 1) = -w;
      spin(1, 0) = w;
      auto const u = uniform(mesh.nodes, spin);

      auto const r_a = values_at<E>(backend, mesh, u, AreaRatio{});

      auto body = body_of<LinearOn<E>>(backend, mesh);
      body.set_displacements(u);
      CHECK(strain_energy(body) < 1e4 * epsilon * epsilon * w * w);
      for (double r : r_a) CHECK(r == Approx(w * w).margin(128 * epsilon * (w + w * w)));
    }
  });
}

TEST_CASE("a rotation has no R_L and no R_A", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const mesh = distorted_mesh<E>(3);
    for (double angle : {1e-3, 0.4, 1.5, 3.0}) {
      auto const u = uniform(mesh.nodes, less_identity(turn<E::dim>(angle, {1, -2, 0.5})));
      double const rounding = 64 * epsilon * std::min(angle, 2.0) + 1e-14;
      for (double r : values_at<E>(backend, mesh, u, EdgeLengthRatio{})) CHECK(r / rounding < 1);
      for (double r : values_at<E>(backend, mesh, u, AreaRatio{})) CHECK(r / rounding < 1);
    }
  });
}

}  // namespace pliant::test::deformation_criteria_suite

#pragma once

#include "support/assembly.hpp"
#include "support/formulations.hpp"

namespace pliant::test::lumped_bar_suite {

/// A bar of n cells and length 1 along x.
template <Element E>
Mesh<E> bar(int n) {
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {1, 0.05}, .cells = {n, 1}});
  else
    return mesh::box<E>({.size = {1, 0.05, 0.05}, .cells = {n, 1, 1}});
}

template <class F, class B>
void check_frequencies(B const& backend) {
  INFO(formulation_name<F>());
  // The modulus of a bar that cannot move sideways is λ + 2μ = 7 Pa; a wave runs at 1 m/s.
  Elastic const material{5.2, 0.3, 7};
  double const pi = std::acos(-1.0);
  for (int n : {4, 8, 16}) {
    INFO(n << " elements");
    auto const mesh = bar<typename F::element>(n);
    auto body = body_of<F>(backend, mesh, material);
    auto const moves = [&](std::size_t node, std::size_t direction) {
      return direction == 0 && mesh.nodes[node][0] > 0;
    };

    auto const squares = squared_frequencies(body, FieldOf<F::dim>(mesh.nodes.size()), moves);

    std::map<int, double> const first{
        {4, 1.560722576129}, {8, 1.568274245273}, {16, 1.570165578477}};  // REFERENCES, section 11
    CHECK(std::sqrt(squares[0]) == Approx(first.at(n)).epsilon(1e-12));
    for (int k = 1; k <= n; ++k) {
      double const exact = 2 * n * std::sin((2 * k - 1) * pi / (4 * n));
      double nearest = INFINITY;
      for (double s : squares) nearest = std::min(nearest, std::abs(std::sqrt(s) - exact));
      CHECK(nearest < 1e-9 * exact);
    }
  }
}

TEST_CASE("a bar of lumped masses has its frequencies", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_frequencies<Formulation<Quad4, Gauss<2>, Hooke>>(backend);
    check_frequencies<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend);
  });
}

TEST_CASE("a bar swings at the frequency of its mode and step", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Quad4, Gauss<2>, Hooke>;
    int const n = 8;
    auto const mesh = bar<Quad4>(n);
    auto body = body_of<F>(backend, mesh, {5.2, 0.3, 7});
    std::vector<Index> all(mesh.nodes.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    body.hold(all, 2);
    body.clamp(mesh.boundary("left"));
    double const pi = std::acos(-1.0), omega = 1.568274245273, dt = 0.02;
    FieldOf<2> mode(mesh.nodes.size());
    for (std::size_t i = 0; i < mode.size(); ++i) mode[i][0] = std::sin(pi / 2 * mesh.nodes[i][0]);
    body.set_displacements(mode);
    CentralDifference step{{.step = dt}};

    // Central differences swing a mode exactly as cos(Ω t) with sin(Ω dt/2) = ω dt/2.
    double const numerical = 2 / dt * std::asin(omega * dt / 2);
    for (int k = 1; k <= 500; ++k) {
      step(body);
      if (k % 50 == 0) {
        double const swing = std::cos(numerical * k * dt);
        CHECK(difference(body.displacements(), plus(FieldOf<2>(mode.size()), swing, mode)) < 1e-9);
      }
    }
  });
}

}  // namespace pliant::test::lumped_bar_suite

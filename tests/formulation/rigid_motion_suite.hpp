#pragma once

#include "support/formulations.hpp"

namespace pliant::test::rigid_motion_suite {

/// The rotation by an angle about an axis of length one (Rodrigues); in 2D about z.
template <int Dim>
Tensor<double, Dim> rotation(double angle, std::array<double, 3> const& axis) {
  double const c = std::cos(angle), s = std::sin(angle);
  Tensor<double, 3> r;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      r(static_cast<int>(i), static_cast<int>(j)) = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j];
  for (std::size_t k = 0; k < 3; ++k) {
    r(static_cast<int>((k + 2) % 3), static_cast<int>((k + 1) % 3)) += s * axis[k];
    r(static_cast<int>((k + 1) % 3), static_cast<int>((k + 2) % 3)) -= s * axis[k];
  }
  Tensor<double, Dim> block;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) block(i, j) = r(i, j);
  return block;
}

/// By 90, 180 and 37 degrees; in 3D about (1, 1, 1).
template <int Dim>
std::vector<Tensor<double, Dim>> rotations() {
  double const third = 1 / std::sqrt(3.0), pi = std::acos(-1.0);
  std::array<double, 3> const axis =
      Dim == 3 ? std::array{third, third, third} : std::array{0.0, 0.0, 1.0};
  return {rotation<Dim>(pi / 2, axis), rotation<Dim>(pi, axis), rotation<Dim>(37 * pi / 180, axis)};
}

TEST_CASE("a rigid motion leaves the energy alone and makes no force", "[formulation]") {
  on_each_formulation<PairedBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    if constexpr (!small_strain<F>) {
      int const n = dim == 2 ? 6 : 4;
      auto const mesh = distorted_mesh<typename F::element>(n);
      auto body = body_among_all<F>(B{}, mesh);
      for (auto const& r : rotations<dim>()) {
        auto u = uniform(mesh.nodes, r - Tensor<double, dim>::identity());
        for (auto& v : u) v[0] += 0.75;

        auto const f = forces_at(body, u);
        double const energy = strain_energy(body);

        // Displacements of about 3 sizes are rounded; divided by the element's size that is a strain.
        double const strain =
            8 * double{std::numeric_limits<typename B::scalar>::epsilon()} * n * largest(u);
        double const modulus = soft.lame_lambda() + 2 * soft.lame_mu();
        CHECK(largest(f) < 4 * modulus * strain * std::pow(1.0 / n, dim - 1));
        CHECK(std::abs(energy) < modulus * strain);
      }
    }
  });
}

TEST_CASE("Hooke's law takes a rotation for a strain of cos(angle) - 1", "[formulation]") {
  on_each_formulation<PairedBackends>([]<class B, class F>(Case<B, F>) {
    constexpr int dim = F::dim;
    if constexpr (std::same_as<typename F::template law<double>, Hooke<double>>) {
      auto const mesh = distorted_mesh<typename F::element>(4);
      auto body = body_among_all<F>(B{}, mesh);
      double const mu = soft.lame_mu(), lambda = soft.lame_lambda();
      double const epsilon = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};
      for (auto const& r : rotations<dim>()) {
        body.set_displacements(uniform(mesh.nodes, r - Tensor<double, dim>::identity()));

        double const energy = strain_energy(body);

        if constexpr (dim == 2) {
          CHECK(energy == Approx((2 * mu + 2 * lambda) * square(1 - r(0, 0))).epsilon(epsilon));
        } else {  // about an axis a: e = (cos − 1)(I − a a), so tr e = 2 (cos − 1), e:e = 2 (cos − 1)²
          double const strain = (trace(r) - 1) / 2 - 1;
          CHECK(energy == Approx((2 * mu + 2 * lambda) * square(strain)).epsilon(epsilon));
        }
      }
    }
  });
}

}  // namespace pliant::test::rigid_motion_suite

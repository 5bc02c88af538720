#pragma once

#include <numbers>

#include "adaptation/criteria.hpp"

namespace pliant::test::rotation_criterion_suite {

TEST_CASE("Rotation is the chord of the angle, whatever the stretch", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    constexpr int dim = E::dim;
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const mesh = distorted_mesh<E>(2);
    Random random(3);
    for (double degrees : {0.0, 1e-3, 5.0, 30.0, 60.0, 90.0, 119.0, 121.0, 150.0, 179.0, 180.0}) {
      INFO(degrees << " degrees");
      double const angle = degrees * std::numbers::pi / 180;
      // Along axes of their own; the last is nearly flat.
      for (Point<3> const& lengths :
           {Point<3>{1, 1, 1}, Point<3>{2, 0.5, 1.3}, Point<3>{1, 0.1, 1.2}}) {
        bool const stretched = lengths[0] != lengths[2];
        INFO("stretches " << lengths[0] << ", " << lengths[1] << ", " << lengths[2]);
        Point<3> const axis{random(), random(), random() + 1.5};
        auto const turned = turn<dim>(random() * 3, {random(), random(), random() + 1.5});
        auto stretch = Tensor<double, dim>::identity();
        for (int i = 0; i < dim; ++i) stretch(i, i) = lengths[static_cast<std::size_t>(i)];
        Tensor<double, dim> const f =
            turn<dim>(angle, axis) * (turned * stretch * transpose(turned));
        auto const u = uniform(mesh.nodes, less_identity(f));

        // Displacements of order one are rounded over edges of 0.5; stretches magnify by 4.
        double const rounding = 64 * epsilon * (stretched ? 4 : std::min(1.0, angle)) + 1e-14;
        for (double r : values_at<E>(backend, mesh, u, Rotation{}))
          CHECK(std::abs(r - 2 * std::sin(angle / 2)) / rounding < 1);
      }
    }
  });
}

}  // namespace pliant::test::rotation_criterion_suite

#pragma once

#include "scene/carve.hpp"
#include "work_precision/laws.hpp"

namespace pliant::bench {

/// A stiff block with a slender arm that swings under its weight.
struct Arm {
  static constexpr int block = 8, length = 16, first = 3,
                       last = 5;         // cells; the arm's are [first, last)²
  static constexpr double edge = 0.125;  // m
  static constexpr double volume =
      edge * edge * edge * (block * block * block + length * (last - first) * (last - first));
  static constexpr Elastic material{.young = 3e6, .poisson = 0.3, .density = 1e3};
  static constexpr int samples = 100;
  /// In the middle of the arm's end.
  static constexpr Point<3> place{(block + length) * edge, (first + last) * edge / 2,
                                  (first + last) * edge / 2};

  /// A cube of block³ cells, and an arm from the middle of its right side.
  template <Element E>
  static Mesh<E> mesh() {
    int const cells = block + length;
    auto const grid = mesh::box<E>(
        {.size = {cells * edge, block * edge, block * edge}, .cells = {cells, block, block}});
    auto mesh = scene::carve(grid, [](Point<3> const& p) {
      auto const in_arm = [](double x) { return x > first * edge && x < last * edge; };
      return p[0] > block * edge && !(in_arm(p[1]) && in_arm(p[2]));
    });
    mesh.boundaries["left"] =
        mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[0] < 1e-9; });
    return mesh;
  }
  template <class TheBody>
  static void begin(TheBody& body) {
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -9.81, 0});
  }
};

/// Under Corotated, which is Hooke's law where nothing turns.
template <Element E>
void swing_corotated(std::string const& problem, Options const& options) {
  LawContest<Arm, E, Corotated> arm(options, "Corotated");
  arm.template add_plain<double, Hooke>("Hooke");
  arm.template add_plain<double, SaintVenantKirchhoff>("Saint Venant-Kirchhoff");
  arm.template add_plain<double, Corotated>("Corotated");
  arm.template add_plain<float, Corotated>("Corotated, float");
  for (double above : {0.005, 0.02, 0.05})
    arm.template add_adaptive<Hooke>("Hooke", largest(StrainNorm{}, Rotation{}), above);
  for (double above : {0.005, 0.02, 0.05})
    arm.template add_adaptive<SaintVenantKirchhoff>("Saint Venant-Kirchhoff", StrainNorm{}, above);
  arm.hold(problem, options);
}

}  // namespace pliant::bench

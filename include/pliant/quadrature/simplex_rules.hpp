#pragma once

#include <pliant/quadrature/quadrature.hpp>

// Rules on triangles and tetrahedra whose weights are all positive and whose points lie inside.
namespace pliant::detail {

/// The points of a rule that permute barycentric coordinates, gathered orbit by orbit.
template <int Dim, int Count>
struct Orbits {
  QuadratureRule<Dim, Count> rule{};
  int filled = 0;

  /// The point whose barycentric coordinates are all but one `a`; each in turn is the other one.
  PLIANT_HOST_DEVICE constexpr Orbits& around(double a, double weight) {
    for (int other = 0; other <= Dim; ++other) {
      double l[Dim + 1]{};
      for (int i = 0; i <= Dim; ++i) l[i] = i == other ? 1 - Dim * a : a;
      add(l, weight);
    }
    return *this;
  }
  PLIANT_HOST_DEVICE constexpr Orbits& centre(double weight) {
    double l[Dim + 1]{};
    for (double& x : l) x = 1.0 / (Dim + 1);
    return add(l, weight);
  }
  /// All points with coordinates a, b at two places and the rest shared by the others.
  PLIANT_HOST_DEVICE constexpr Orbits& pairs(double a, double b, double weight) {
    double const rest = (1 - a - b) / (Dim - 1);
    for (int i = 0; i <= Dim; ++i)
      for (int j = 0; j <= Dim; ++j) {
        if (i == j) continue;
        double l[Dim + 1]{};
        for (int k = 0; k <= Dim; ++k) l[k] = k == i ? a : k == j ? b : rest;
        add(l, weight);
      }
    return *this;
  }
  /// On tetrahedra: two coordinates a, two 1/2 − a.
  PLIANT_HOST_DEVICE constexpr Orbits& halves(double a, double weight) {
    for (int i = 0; i <= Dim; ++i)
      for (int j = i + 1; j <= Dim; ++j) {
        double l[Dim + 1]{};
        for (int k = 0; k <= Dim; ++k) l[k] = k == i || k == j ? a : 0.5 - a;
        add(l, weight);
      }
    return *this;
  }

 private:
  PLIANT_HOST_DEVICE constexpr Orbits& add(double const (&l)[Dim + 1], double weight) {
    for (int k = 0; k < Dim; ++k) rule.points[filled][k] = l[k + 1];
    rule.weights[filled++] = weight;
    return *this;
  }
};

/// The centroid; 3 points (Strang and Fix); 6 of degree 4 and 12 of degree 6 (Dunavant 1985); 7 of
/// degree 5 (Radon 1948).
template <int Degree>
PLIANT_HOST_DEVICE constexpr auto triangle_rule() {
  static_assert(Degree >= 1 && Degree <= 6, "Gauss<n> on triangles is exact for degree n = 1 to 6");
  if constexpr (Degree == 1) return Orbits<2, 1>{}.centre(0.5).rule;
  if constexpr (Degree == 2) return Orbits<2, 3>{}.around(1.0 / 6, 1.0 / 6).rule;
  if constexpr (Degree == 3 || Degree == 4)
    return Orbits<2, 6>{}
        .around(0.44594849091596488632, 0.11169079483900573285)
        .around(0.09157621350977074346, 0.05497587182766093382)
        .rule;
  if constexpr (Degree == 5)
    return Orbits<2, 7>{}
        .centre(9.0 / 80)
        .around(0.10128650732345633880, 0.06296959027241357630)
        .around(0.47014206410511508977, 0.06619707639425309037)
        .rule;
  if constexpr (Degree == 6)
    return Orbits<2, 12>{}
        .around(0.24928674517091042129, 0.05839313786318968301)
        .around(0.06308901449150222834, 0.02542245318510340846)
        .pairs(0.05314504984481694735, 0.31035245103378440542, 0.04142553780918678760)
        .rule;
}

/// The centroid; 4 points of degree 2; 14 of degree 5 (Walkington 2000); 24 of degree 6 (Keast 1986).
template <int Degree>
PLIANT_HOST_DEVICE constexpr auto tetrahedron_rule() {
  static_assert(Degree >= 1 && Degree <= 6,
                "Gauss<n> on tetrahedra is exact for degree n = 1 to 6");
  if constexpr (Degree == 1) return Orbits<3, 1>{}.centre(1.0 / 6).rule;
  if constexpr (Degree == 2) return Orbits<3, 4>{}.around(0.13819660112501051518, 1.0 / 24).rule;
  if constexpr (Degree >= 3 && Degree <= 5)
    return Orbits<3, 14>{}
        .around(0.31088591926330060980, 0.11268792571801585080 / 6)
        .around(0.09273525031089122640, 0.07349304311636194934 / 6)
        .halves(0.04550370412564964949, 0.04254602077708146644 / 6)
        .rule;
  if constexpr (Degree == 6)
    return Orbits<3, 24>{}
        .around(0.21460287125915202928, 0.03992275025816749210 / 6)
        .around(0.04067395853461135311, 0.01007721105532064294 / 6)
        .around(0.32233789014227551034, 0.05535718154365472210 / 6)
        .pairs(0.26967233145831580803, 0.60300566479164914136, 27.0 / 560 / 6)
        .rule;
}

}  // namespace pliant::detail

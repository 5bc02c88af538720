#pragma once

#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

namespace detail {

/// Gauss-Legendre on [−1, 1] (Abramowitz and Stegun, table 25.4).
template <int N>
PLIANT_HOST_DEVICE constexpr QuadratureRule<1, N> gauss_legendre() {
  static_assert(N >= 1 && N <= 4,
                "Gauss<n> on quadrilaterals and hexahedra has 1 to 4 points per direction");
  if constexpr (N == 1) return {{{0}}, {2}};
  if constexpr (N == 2) return {{{-0.57735026918962576451}, {0.57735026918962576451}}, {1, 1}};
  if constexpr (N == 3)
    return {{{-0.77459666924148337704}, {0}, {0.77459666924148337704}},
            {5.0 / 9, 8.0 / 9, 5.0 / 9}};
  if constexpr (N == 4)
    return {{{-0.86113631159405257522},
             {-0.33998104358485626480},
             {0.33998104358485626480},
             {0.86113631159405257522}},
            {0.34785484513745385737, 0.65214515486254614263, 0.65214515486254614263,
             0.34785484513745385737}};
}

/// Triangles: the centroid, Strang and Fix's 3 interior points, Dunavant's 6 points of degree 4.
template <int Degree>
PLIANT_HOST_DEVICE constexpr auto triangle_rule() {
  static_assert(Degree >= 1 && Degree <= 4, "Gauss<n> on triangles is exact for degree n = 1 to 4");
  if constexpr (Degree == 1) return QuadratureRule<2, 1>{{{1.0 / 3, 1.0 / 3}}, {0.5}};
  if constexpr (Degree == 2)
    return QuadratureRule<2, 3>{{{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}},
                                {1.0 / 6, 1.0 / 6, 1.0 / 6}};
  if constexpr (Degree >= 3) {
    constexpr double a = 0.44594849091596488632, b = 0.09157621350977074346;
    constexpr double v = 0.11169079483900573285, w = 0.05497587182766093382;
    return QuadratureRule<2, 6>{
        {{a, a}, {1 - 2 * a, a}, {a, 1 - 2 * a}, {b, b}, {1 - 2 * b, b}, {b, 1 - 2 * b}},
        {v, v, v, w, w, w}};
  }
}

/// Tetrahedra: the centroid, 4 points of degree 2, Walkington's 14 points of degree 5.
template <int Degree>
PLIANT_HOST_DEVICE constexpr auto tetrahedron_rule() {
  static_assert(Degree >= 1 && Degree <= 5,
                "Gauss<n> on tetrahedra is exact for degree n = 1 to 5");
  if constexpr (Degree == 1) return QuadratureRule<3, 1>{{{0.25, 0.25, 0.25}}, {1.0 / 6}};
  if constexpr (Degree == 2) {
    constexpr double a = 0.13819660112501051518, b = 0.58541019662496845446, w = 1.0 / 24;
    return QuadratureRule<3, 4>{{{a, a, a}, {b, a, a}, {a, b, a}, {a, a, b}}, {w, w, w, w}};
  }
  if constexpr (Degree >= 3) {
    constexpr double a = 0.31088591926330060980, b = 0.09273525031089122640;
    constexpr double c = 0.04550370412564964949, d = 0.5 - c;
    constexpr double u = 0.11268792571801585080 / 6, v = 0.07349304311636194934 / 6;
    constexpr double w = 0.04254602077708146644 / 6;
    return QuadratureRule<3, 14>{{{a, a, a},
                                  {1 - 3 * a, a, a},
                                  {a, 1 - 3 * a, a},
                                  {a, a, 1 - 3 * a},
                                  {b, b, b},
                                  {1 - 3 * b, b, b},
                                  {b, 1 - 3 * b, b},
                                  {b, b, 1 - 3 * b},
                                  {c, c, d},
                                  {c, d, c},
                                  {d, c, c},
                                  {d, d, c},
                                  {d, c, d},
                                  {c, d, d}},
                                 {u, u, u, u, v, v, v, v, w, w, w, w, w, w}};
  }
}

}  // namespace detail

/// Gauss quadrature. On tensor cells, N points per direction (exact to degree 2N − 1); on
/// simplices, the rule with positive weights and fewest points that is exact to degree N or more.
template <int N>
struct Gauss {
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    if constexpr (std::same_as<Cell, Triangle>) {
      return detail::triangle_rule<N>();
    } else if constexpr (std::same_as<Cell, Tetrahedron>) {
      return detail::tetrahedron_rule<N>();
    } else {
      constexpr auto line = detail::gauss_legendre<N>();
      constexpr int count = Cell::dim == 2 ? N * N : N * N * N;
      QuadratureRule<Cell::dim, count> tensor{};
      for (int q = 0; q < count; ++q) {
        tensor.weights[q] = 1;
        for (int k = 0, rest = q; k < Cell::dim; ++k, rest /= N) {
          tensor.points[q][k] = line.points[rest % N][0];
          tensor.weights[q] *= line.weights[rest % N];
        }
      }
      return tensor;
    }
  }
};

}  // namespace pliant

#pragma once

#include <pliant/quadrature/gauss.hpp>

namespace pliant {

/// The Gauss rule with fewest points that is exact for polynomials of a degree: of the total degree on
/// simplices, in each direction elsewhere.
template <int Degree>
struct Exact {
  static constexpr int per_direction = Degree / 2 + 1;

  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    if constexpr (SimplexCell<Cell>)
      return Gauss<Degree>::template rule<Cell>();
    else if constexpr (std::same_as<Cell, Wedge>)
      return detail::on_wedge(detail::triangle_rule<Degree>(),
                              detail::gauss_jacobi<per_direction>());
    else
      return Gauss<per_direction>::template rule<Cell>();
  }
};

/// The Gauss rule with a number of points in all.
template <int Count>
struct Points {
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    constexpr int n = size<Cell>();
    static_assert(
        n > 0,
        "no Gauss rule of this cell has so many points: triangles have rules of 1, 3, 6, 7 "
        "and 12, tetrahedra of 1, 4, 14 and 24, quadrilaterals of n^2, hexahedra and "
        "pyramids of n^3, wedges of 1, 6, 18 and 24");
    return Gauss<n>::template rule<Cell>();
  }

 private:
  /// The n whose Gauss<n> has so many points; 0 where none does.
  template <class Cell, int N = 1>
  static constexpr int size() {
    constexpr int most = SimplexCell<Cell> ? 6 : std::same_as<Cell, Wedge> ? 4 : 10;
    if constexpr (N > most)
      return 0;
    else if constexpr (decltype(Gauss<N>::template rule<Cell>())::count == Count)
      return N;
    else
      return size<Cell, N + 1>();
  }
};

}  // namespace pliant

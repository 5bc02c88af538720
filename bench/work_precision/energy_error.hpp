#pragma once

#include <cmath>

#include <pliant/pliant.hpp>

// The energy norm of the error beside an exact field that may be singular at one place.
namespace pliant::bench {

/// A part of an element's cell, by its corners.
template <Element E>
struct Piece {
  std::array<Vector<double, E::dim>, E::cell::corners> corners;

  static Piece whole() {
    Piece piece;
    for (int c = 0; c < E::cell::corners; ++c)
      piece.corners[static_cast<std::size_t>(c)] = E::cell::corner(c);
    return piece;
  }
  Vector<double, E::dim> at(Vector<double, E::dim> const& xi) const {
    auto const share = E::cell::linear(xi);
    auto sum = Vector<double, E::dim>::zero();
    for (int c = 0; c < E::cell::corners; ++c)
      sum = sum + share[c] * corners[static_cast<std::size_t>(c)];
    return sum;
  }
  /// Quarters, by the middles of the sides.
  std::array<Piece, 4> quarters() const {
    constexpr int n = E::cell::corners;
    std::array<Vector<double, 2>, 4> middle;
    auto centre = Vector<double, 2>::zero();
    for (std::size_t c = 0; c < n; ++c) {
      middle[c] = 0.5 * (corners[c] + corners[(c + 1) % n]);
      centre = centre + 1.0 / n * corners[c];
    }
    if constexpr (n == 3)
      return {{{{corners[0], middle[0], middle[2]}},
               {{middle[0], corners[1], middle[1]}},
               {{middle[2], middle[1], corners[2]}},
               {{middle[0], middle[1], middle[2]}}}};
    else
      return {{{{corners[0], middle[0], centre, middle[3]}},
               {{middle[0], corners[1], middle[1], centre}},
               {{centre, middle[1], corners[2], middle[2]}},
               {{middle[3], centre, middle[2], corners[3]}}}};
  }
};

/// ∫ W(H) − W(H̄) − P(H̄) : (H − H̄) dV, J, of a plane body: the strain energy of its error beside the gradient
/// H̄ = exact(X), for a law that is the same everywhere. Elements near `singular` are integrated in pieces that
/// get smaller towards it.
template <Element E, class TheBody, class Law, class Exact>
double energy_of_error(TheBody const& body, Law const& law, Exact const& exact,
                       Point<2> const& singular) {
  using Linear = std::conditional_t<SimplexCell<typename E::cell>, Tri3, Quad4>;
  using Rule = Gauss<SimplexCell<typename E::cell> ? 6 : E::degree + 3>;
  static constexpr auto rule = tabulate<Linear, Rule, double>();
  constexpr int deepest = 14;
  auto const& mesh = body.mesh();
  auto const u = body.displacements();
  double sum = 0;
  for (auto const& element : mesh.template elements<E>()) {
    auto const rest = nodal(mesh, element);
    Nodal<E, double> own;
    for (int a = 0; a < E::nodes; ++a)
      for (std::size_t k = 0; k < 2; ++k)
        own(a, static_cast<int>(k)) =
            u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])][k];
    auto const place = [&](Vector<double, 2> const& xi) { return transpose(rest) * E::shape(xi); };
    auto const integrate = [&](auto const& self, Piece<E> const& piece, int depth) -> void {
      double distance = INFINITY, size = 0;
      for (std::size_t c = 0; c < piece.corners.size(); ++c) {
        auto const here = place(piece.corners[c]),
                   next = place(piece.corners[(c + 1) % piece.corners.size()]);
        distance = std::min(distance, std::hypot(here[0] - singular[0], here[1] - singular[1]));
        size = std::max(size, std::hypot(here[0] - next[0], here[1] - next[1]));
      }
      if (distance < size && depth < deepest) {
        for (auto const& quarter : piece.quarters()) self(self, quarter, depth + 1);
        return;
      }
      Nodal<Linear, double> outline;
      for (int c = 0; c < E::cell::corners; ++c)
        for (int k = 0; k < 2; ++k) outline(c, k) = piece.corners[static_cast<std::size_t>(c)][k];
      for (int q = 0; q < rule.count; ++q) {
        auto const map =
            RestMap<Linear, double>::at(Coefficients<Linear, double>::of(outline), rule, q);
        auto xi = Vector<double, 2>::zero();
        for (int a = 0; a < Linear::nodes; ++a)
          for (int k = 0; k < 2; ++k) xi[k] += rule.shape[q][a] * outline(a, k);
        auto const slopes = shape_gradient<E>(xi);
        Tensor<double, 2> const jacobian = transpose(rest) * slopes;
        double const volume = jacobian(0, 0) * jacobian(1, 1) - jacobian(0, 1) * jacobian(1, 0);
        Tensor<double, 2> const h =
            1 / volume * ((transpose(own) * slopes) * transpose(cofactor(jacobian)));
        auto const at = place(xi);
        Tensor<double, 2> const answer = exact(Point<2>{at[0], at[1]});
        sum += map.volume * volume * rule.weight[q] *
               (energy_density(law, h) - energy_density(law, answer) -
                dot(stress(law, answer), h - answer));
      }
    };
    integrate(integrate, Piece<E>::whole(), 0);
  }
  return sum;
}

}  // namespace pliant::bench

#pragma once

#include <cmath>
#include <optional>

#include <pliant/pliant.hpp>

#include "verification/support/grading.hpp"

// Integrals of the error beside an exact field that may be singular at one place.
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
  /// Of a plane cell, by the middles of the sides.
  std::array<Piece, 4> quarters() const
    requires(E::dim == 2)
  {
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

/// Whether a piece is larger than its distance from a place.
template <Element E, class PlaceOf>
bool is_near(Piece<E> const& piece, Point<2> const& place, PlaceOf const& place_of) {
  double distance = INFINITY, size = 0;
  for (std::size_t c = 0; c < piece.corners.size(); ++c) {
    auto const here = place_of(piece.corners[c]),
               next = place_of(piece.corners[(c + 1) % piece.corners.size()]);
    distance = std::min(distance, std::hypot(here[0] - place[0], here[1] - place[1]));
    size = std::max(size, std::hypot(here[0] - next[0], here[1] - next[1]));
  }
  return distance < size;
}

/// Calls visit(X, H, volume) at the points of a rule finer than the elements of a type need; of plane bodies in pieces that get smaller
/// towards `singular`, where that is given.
template <Element E, class TheBody, class Visit>
void for_each_fine_point(TheBody const& body, std::optional<Point<2>> const& singular,
                         Visit const& visit) {
  using Linear = verification::LinearOn<E>;
  using Rule = Gauss<SimplexCell<typename E::cell> ? 6 : E::degree + 3>;
  static constexpr auto rule = tabulate<Linear, Rule, double>();
  constexpr int deepest = 14, dim = E::dim;
  auto const& mesh = body.mesh();
  auto const u = body.displacements();
  for (auto const& element : mesh.template elements<E>()) {
    auto const rest = nodal(mesh, element);
    Nodal<E, double> own;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < dim; ++k)
        own(a, k) = u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])]
                     [static_cast<std::size_t>(k)];
    auto const place = [&](Vector<double, dim> const& xi) {
      return transpose(rest) * E::shape(xi);
    };
    auto const integrate = [&](auto const& self, Piece<E> const& piece, int depth) -> void {
      if constexpr (dim == 2)
        if (singular && depth < deepest && is_near(piece, *singular, place)) {
          for (auto const& quarter : piece.quarters()) self(self, quarter, depth + 1);
          return;
        }
      Nodal<Linear, double> outline;
      for (int c = 0; c < E::cell::corners; ++c)
        for (int k = 0; k < dim; ++k) outline(c, k) = piece.corners[static_cast<std::size_t>(c)][k];
      for (int q = 0; q < rule.count; ++q) {
        auto const map =
            RestMap<Linear, double>::at(Coefficients<Linear, double>::of(outline), rule, q);
        auto xi = Vector<double, dim>::zero();
        for (int a = 0; a < Linear::nodes; ++a)
          for (int k = 0; k < dim; ++k) xi[k] += rule.shape[q][a] * outline(a, k);
        auto const slopes = shape_gradient<E>(xi);
        Tensor<double, dim> const jacobian = transpose(rest) * slopes;
        double const volume = determinant(jacobian);
        Tensor<double, dim> const h =
            1 / volume * ((transpose(own) * slopes) * transpose(cofactor(jacobian)));
        auto const at = place(xi);
        Point<dim> X;
        for (int k = 0; k < dim; ++k) X[static_cast<std::size_t>(k)] = at[k];
        visit(X, h, map.volume * volume * rule.weight[q]);
      }
    };
    integrate(integrate, Piece<E>::whole(), 0);
  }
}

/// ∫ W(H) − W(H̄) − P(H̄) : (H − H̄) dV, J, of a plane body: the strain energy of its error beside the gradient
/// H̄ = exact(X), for a law that is the same everywhere.
template <Element E, class TheBody, class Law, class Exact>
double energy_of_error(TheBody const& body, Law const& law, Exact const& exact,
                       std::optional<Point<2>> const& singular) {
  double sum = 0;
  for_each_fine_point<E>(body, singular,
                         [&](Point<2> const& X, Tensor<double, 2> const& h, double volume) {
                           Tensor<double, 2> const answer = exact(X);
                           sum += volume * (energy_density(law, h) - energy_density(law, answer) -
                                            dot(stress(law, answer), h - answer));
                         });
  return sum;
}

/// √(∫ |H − H̄|² dV / ∫ |H̄|² dV) beside the gradient H̄ = exact(X), smooth.
template <Element E, class TheBody, class Exact>
double error_of_gradient(TheBody const& body, Exact const& exact) {
  double off = 0, all = 0;
  for_each_fine_point<E>(
      body, {}, [&](Point<E::dim> const& X, Tensor<double, E::dim> const& h, double volume) {
        Tensor<double, E::dim> const answer = exact(X);
        off += volume * dot(h - answer, h - answer);
        all += volume * dot(answer, answer);
      });
  return std::sqrt(off / all);
}

}  // namespace pliant::bench

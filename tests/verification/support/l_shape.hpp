#pragma once

#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 8: the L-shape of linear elasticity, whose exact solution is singular at the
// re-entrant corner (Alberty, Carstensen, Funken and Klose 2002).
namespace pliant::verification {

inline constexpr double alpha = 0.544483736782464, c1 = 1.841364331170980;
inline Elastic const l_shape_material{1e5, 0.3, 1};

template <class S>
double value_of(S const& x) {
  if constexpr (std::same_as<S, double>)
    return x;
  else
    return x.value;
}

/// Displacement by Cartesian components, of dual numbers too.
template <class S>
Vector<S, 2> exact_in_l_shape(S const& x, S const& y) {
  double const c2 = 2 * (l_shape_material.lame_lambda() + 2 * l_shape_material.lame_mu()) /
                    (l_shape_material.lame_lambda() + l_shape_material.lame_mu());
  // In polar coordinates, with derivatives by hand.
  double const px = value_of(x), py = value_of(y), r = std::hypot(px, py);
  auto const lifted = [&](double value, double by_x, double by_y) {
    S s(value);
    if constexpr (!std::same_as<S, double>)
      for (int k = 0; k < 2; ++k) s.derivative[k] = by_x * x.derivative[k] + by_y * y.derivative[k];
    return s;
  };
  S const theta = lifted(std::atan2(py, px), -py / (r * r), px / (r * r));
  S const power = lifted(std::pow(r, alpha), alpha * std::pow(r, alpha - 2) * px,
                         alpha * std::pow(r, alpha - 2) * py);
  auto const function = [&](double value, double slope) {
    return lifted(value, -slope * py / (r * r), slope * px / (r * r));
  };
  double const t = value_of(theta);
  auto const cosine = [&](double m) { return function(std::cos(m * t), -m * std::sin(m * t)); };
  auto const sine = [&](double m) { return function(std::sin(m * t), m * std::cos(m * t)); };
  double const scale = 1 / (2 * l_shape_material.lame_mu());
  S const radial = scale * power *
                   (-(alpha + 1) * cosine(alpha + 1) + (c2 - (alpha + 1)) * c1 * cosine(alpha - 1));
  S const across =
      scale * power * ((alpha + 1) * sine(alpha + 1) + (c2 + alpha - 1) * c1 * sine(alpha - 1));
  return {{{radial * cosine(1) - across * sine(1)}, {radial * sine(1) + across * cosine(1)}}};
}
inline Point<2> displacement_in_l_shape(Point<2> const& p) {
  if (std::hypot(p[0], p[1]) < 1e-14) return {0, 0};
  auto const u = exact_in_l_shape(p[0], p[1]);
  return {u[0], u[1]};
}

/// ∂u_i/∂X_k.
inline Tensor<double, 2> gradient_in_l_shape(Point<2> const& p) {
  using Variable = Dual<double, 2>;
  auto const field = exact_in_l_shape(Variable::variable(p[0], 0), Variable::variable(p[1], 1));
  Tensor<double, 2> h;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k) h(i, k) = field[i].derivative[k];
  return h;
}
/// On the sides away from the re-entrant corner.
inline bool on_outer_l_shape(Point<2> const& p) {
  return std::abs(std::abs(p[0]) + std::abs(p[1]) - 2) < 1e-12;
}

/// The energy norm of the error of a body's displacements, under plane strain in 3D.
template <Element E, class TheBody>
double error_in_l_shape(TheBody const& body) {
  static constexpr auto points = tabulate<E, Gauss<(E::dim == 2 ? 6 : 4)>, double>();
  auto const law = Hooke<double>::from(l_shape_material);
  auto const& mesh = body.mesh();
  auto const u = body.displacements();
  double squares = 0;
  for (auto const& element : mesh.template elements<E>()) {
    auto const rest = nodal(mesh, element);
    Nodal<E, double> own;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k)
        own(a, k) = u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])]
                     [static_cast<std::size_t>(k)];
    auto const x = Coefficients<E, double>::of(rest), v = Coefficients<E, double>::of(own);
    for (int q = 0; q < points.count; ++q) {
      auto const map = RestMap<E, double>::at(x, points, q);
      Point<2> place{};
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < 2; ++k)
          place[static_cast<std::size_t>(k)] += points.shape[q][a] * rest(a, k);
      auto off = map.gradient(v, points, q);
      auto const exact = gradient_in_l_shape(place);
      for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) off(i, k) = off(i, k) - exact(i, k);
      squares += 2 * energy_density(law, off) * map.volume * points.weight[q];
    }
  }
  return std::sqrt(squares);
}

/// Three squares around the origin, n x n cells in each, turned by 45 degrees.
template <Element E>
Mesh<E> l_shape(int n, double power) {
  using Linear = LinearOn<E>;
  auto const square =
      mesh::rectangle<Linear>({.size = {2, 2}, .cells = {2 * n, 2 * n}, .origin = {-1, -1}});
  Mesh<Linear> corner;
  std::vector<Index> number(square.nodes.size(), -1);
  for (auto element : square.template elements<Linear>()) {
    double x = 0, y = 0;
    for (Index node : element) {
      x += square.nodes[static_cast<std::size_t>(node)][0];
      y += square.nodes[static_cast<std::size_t>(node)][1];
    }
    if (x < 0 && y < 0) continue;
    for (Index& node : element) {
      Index& renumbered = number[static_cast<std::size_t>(node)];
      if (renumbered < 0) {
        renumbered = static_cast<Index>(corner.nodes.size());
        corner.nodes.push_back(square.nodes[static_cast<std::size_t>(node)]);
      }
      node = renumbered;
    }
    corner.template elements<Linear>().push_back(element);
  }
  for (auto& p : corner.nodes) {
    for (double& x : p) x = std::copysign(std::pow(std::abs(x), power), x);
    p = {p[0] + p[1], p[1] - p[0]};
  }
  if constexpr (E::degree > 1)
    return mesh::raised<E>(corner);
  else
    return corner;
}

}  // namespace pliant::verification

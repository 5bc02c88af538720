#include <numbers>

#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 8: the L-shape of linear elasticity, whose exact solution is singular at the
// re-entrant corner (Alberty, Carstensen, Funken and Klose 2002). Rates in the energy norm: alpha on
// uniform meshes, whatever the element; the element's degree on meshes graded well enough.
namespace pliant::verification {

constexpr double alpha = 0.544483736782464, c1 = 1.841364331170980;
Elastic const material{1e5, 0.3, 1};

template <class S>
double value_of(S const& x) {
  if constexpr (std::same_as<S, double>)
    return x;
  else
    return x.value;
}

/// Displacement by Cartesian components, of dual numbers too.
template <class S>
Vector<S, 2> exact(S const& x, S const& y) {
  double const c2 = 2 * (material.lame_lambda() + 2 * material.lame_mu()) /
                    (material.lame_lambda() + material.lame_mu());
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
  double const scale = 1 / (2 * material.lame_mu());
  S const radial = scale * power *
                   (-(alpha + 1) * cosine(alpha + 1) + (c2 - (alpha + 1)) * c1 * cosine(alpha - 1));
  S const across =
      scale * power * ((alpha + 1) * sine(alpha + 1) + (c2 + alpha - 1) * c1 * sine(alpha - 1));
  return {{{radial * cosine(1) - across * sine(1)}, {radial * sine(1) + across * cosine(1)}}};
}
Point<2> displacement(Point<2> const& p) {
  if (std::hypot(p[0], p[1]) < 1e-14) return {0, 0};
  auto const u = exact(p[0], p[1]);
  return {u[0], u[1]};
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

/// The energy norm of the error, and the strain energy.
template <Element E>
Runs solved(std::vector<int> const& sizes, double power) {
  using F = Formulation<E, Full<E>, Hooke>;
  return on_meshes(sizes, 2, [&](int n) {
    auto const mesh = l_shape<E>(n, power);
    auto body = body_of<F>(mesh, material);
    std::vector<Point<2>> u;
    for (auto const& p : mesh.nodes) u.push_back(displacement(p));
    body.set_displacements(u);
    body.clamp(mesh::outer_sides_where(mesh, [](Point<2> const& p) {
      return std::abs(std::abs(p[0]) + std::abs(p[1]) - 2) < 1e-12;
    }));
    auto const report = solve_static(body, where_forces_cancel);
    u = body.displacements();

    static constexpr auto points = tabulate<E, Gauss<6>, double>();
    auto const law = Hooke<double>::from(material);
    double squares = 0;
    for (auto const& element : mesh.template elements<E>()) {
      auto const rest = nodal(mesh, element);
      Nodal<E, double> own;
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < 2; ++k)
          own(a, k) = u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])]
                       [static_cast<std::size_t>(k)];
      auto const x = Coefficients<E, double>::of(rest), v = Coefficients<E, double>::of(own);
      for (int q = 0; q < points.count; ++q) {
        auto const map = RestMap<E, double>::at(x, points, q);
        double place[2]{};
        for (int a = 0; a < E::nodes; ++a)
          for (int k = 0; k < 2; ++k) place[k] += points.shape[q][a] * rest(a, k);
        using Variable = Dual<double, 2>;
        auto const field = exact(Variable::variable(place[0], 0), Variable::variable(place[1], 1));
        auto off = map.gradient(v, points, q);
        for (int i = 0; i < 2; ++i)
          for (int k = 0; k < 2; ++k) off(i, k) -= field[i].derivative[k];
        squares += 2 * energy_density(law, off) * map.volume * points.weight[q];
      }
    }
    return std::array{std::sqrt(squares), report.energy};
  });
}

template <Element E>
void rows(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto const uniform = solved<E>(sizes, 1);
  table.converge({"8, L-shape, energy norm", name_of<F>(), "uniform, 3 n x n"}, uniform, 0, alpha);
  auto const well_graded = solved<E>(sizes, E::degree == 1 ? 2.5 : 4.5);
  table.converge({"8, L-shape, energy norm", name_of<F>(), "graded, 3 n x n"}, well_graded, 0,
                 E::degree);
  table.approach({"8, L-shape, energy", name_of<F>(), "graded, 3 n x n"}, well_graded, 1,
                 within(1e-8, 2.054512443695e-4), 2 * E::degree);
  if (E::degree > 1)
    table.compare({"8, L-shape, energy", name_of<F>(), "graded, 3 n x n"}, well_graded, 1,
                  within(1e-9, 2.054512443695e-4));
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  verification::Table table("L-shape (8)", argc, argv);
  verification::rows<Tri3>(table, {16, 32, 64});
  verification::rows<Quad4>(table, {16, 32, 64});
  verification::rows<Tri6>(table, {12, 24, 48});
  verification::rows<Quad8>(table, {12, 24, 48});
  verification::rows<Quad9>(table, {12, 24, 48});
  return table.finish();
}

#pragma once

#include <numbers>

#include "verification/support/statics.hpp"

// Manufactured solutions (REFERENCES, section 9): a field is chosen, and the body force that it needs
// follows from the printed stress of the law, written here a second time so that no mistake cancels.
namespace pliant::verification {

inline constexpr double manufactured_mu = 1, manufactured_lambda = 1.5;

template <class S>
S sine(S const& x);
template <class S>
S cosine(S const& x);
template <>
inline double sine(double const& x) {
  return std::sin(x);
}
template <>
inline double cosine(double const& x) {
  return std::cos(x);
}
template <class S>
S sine(S const& x) {
  return x.chain(sine(x.value), cosine(x.value));
}
template <class S>
S cosine(S const& x) {
  return x.chain(cosine(x.value), -1 * sine(x.value));
}

/// The field.
template <class S>
Vector<S, 2> manufactured(Vector<S, 2> const& X) {
  double const a = 0.03, pi = std::numbers::pi;
  S const x = X[0], y = X[1];
  return {{{a * (sine(pi * x) * sine(pi * y) + 0.5 * (x * y))},
           {a * (cosine(pi * x) * sine(pi * y) + 0.25 * (x * x - y))}}};
}
template <class S>
Vector<S, 3> manufactured(Vector<S, 3> const& X) {
  double const a = 0.03, pi = std::numbers::pi;
  S const x = X[0], y = X[1], z = X[2];
  return {{{a * (sine(pi * x) * cosine(pi / 2 * y) * z)},
           {a * (sine(pi * y) * cosine(pi / 2 * z) * x)},
           {a * (sine(pi * z) * cosine(pi / 2 * x) * y)}}};
}

/// P = F S with S = λ tr E I + 2 μ E; in plane strain E₃₃ = 0.
template <class S, int Dim>
Tensor<S, Dim> printed_stress(SaintVenantKirchhoff<double>, Tensor<S, Dim> const& F) {
  auto E = transpose(F) * F;
  for (int i = 0; i < Dim; ++i) E(i, i) = E(i, i) - 1;
  E = S(0.5) * E;
  auto s = S(2 * manufactured_mu) * E;
  for (int i = 0; i < Dim; ++i) s(i, i) = s(i, i) + manufactured_lambda * trace(E);
  return F * s;
}
/// P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ
template <class S, int Dim>
Tensor<S, Dim> printed_stress(NeoHookean<double>, Tensor<S, Dim> const& F) {
  auto const c = cofactor(F);
  S J = S(0);
  for (int k = 0; k < Dim; ++k) J = J + F(0, k) * c(0, k);
  Tensor<S, Dim> const inverse_transposed = (S(1) / J) * c;
  return S(manufactured_mu) * F +
         (manufactured_lambda * log(J) - manufactured_mu) * inverse_transposed;
}

/// The field and its gradient at a place.
template <int Dim>
struct ExactField {
  Vector<double, Dim> u;
  Tensor<double, Dim> gradient;
};
template <int Dim>
auto exact_at(Point<Dim> const& place) {
  Vector<Dual<double, Dim>, Dim> X;
  for (int k = 0; k < Dim; ++k)
    X[k] = Dual<double, Dim>::variable(place[static_cast<std::size_t>(k)], k);
  auto const u = manufactured(X);
  ExactField<Dim> exact;
  for (int i = 0; i < Dim; ++i) {
    exact.u[i] = u[i].value;
    for (int k = 0; k < Dim; ++k) exact.gradient(i, k) = u[i].derivative[k];
  }
  return exact;
}

/// −Div P, by derivatives of first and second order of the field.
template <template <class> class L, int Dim>
Point<Dim> force_needed(Point<Dim> const& place) {
  using First = Dual<double, Dim>;
  Vector<Dual<First, Dim>, Dim> X;
  for (int k = 0; k < Dim; ++k)
    X[k] = Dual<First, Dim>::variable(First::variable(place[static_cast<std::size_t>(k)], k), k);
  auto const u = manufactured(X);
  Tensor<First, Dim> F;
  for (int i = 0; i < Dim; ++i)
    for (int k = 0; k < Dim; ++k) F(i, k) = u[i].derivative[k] + (i == k ? 1.0 : 0.0);
  auto const p = printed_stress(L<double>{}, F);
  Point<Dim> b{};
  for (int i = 0; i < Dim; ++i)
    for (int k = 0; k < Dim; ++k) b[static_cast<std::size_t>(i)] -= p(i, k).derivative[k];
  return b;
}

/// The norms in L² and of the gradient in L² of what a nodal field is off the exact one.
template <Element E>
std::array<double, 2> errors_of(Mesh<E> const& mesh, std::vector<Point<E::dim>> const& u) {
  using Q = Gauss<SimplexCell<typename E::cell> ? 2 * E::degree + 2 : E::degree + 2>;
  static constexpr auto table = tabulate<E, Q, double>();
  double in_u = 0, in_gradient = 0;
  for (auto const& element : mesh.template elements<E>()) {
    auto const rest = nodal(mesh, element);
    Nodal<E, double> own;
    for (int a = 0; a < E::nodes; ++a)
      for (std::size_t k = 0; k < E::dim; ++k)
        own(a, static_cast<int>(k)) =
            u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])][k];
    auto const x = Coefficients<E, double>::of(rest), v = Coefficients<E, double>::of(own);
    for (int q = 0; q < table.count; ++q) {
      Point<E::dim> place{};
      auto here = Vector<double, E::dim>::zero();
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < E::dim; ++k) {
          place[static_cast<std::size_t>(k)] += table.shape[q][a] * rest(a, k);
          here[k] += table.shape[q][a] * own(a, k);
        }
      auto const exact = exact_at<E::dim>(place);
      auto const map = RestMap<E, double>::at(x, table, q);
      double const volume = map.volume * table.weight[q];
      auto const off = here - exact.u;
      auto const off_gradient = map.gradient(v, table, q) - exact.gradient;
      in_u += volume * dot(off, off);
      in_gradient += volume * dot(off_gradient, off_gradient);
    }
  }
  return {std::sqrt(in_u), std::sqrt(in_gradient)};
}

/// The unit square or cube; curved: with its inner nodes moved along a smooth field.
enum class Grid { straight, curved };
template <Element E>
Mesh<E> unit_grid(int n, Grid grid) {
  Mesh<E> mesh;
  if constexpr (E::dim == 2)
    mesh = mesh::rectangle<E>({.size = {1, 1}, .cells = {n, n}});
  else
    mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {n, n, n}});
  if (grid == Grid::curved)
    for (auto& p : mesh.nodes) {
      double bump = 0.15;
      for (double x : p) bump *= std::sin(std::numbers::pi * x);
      p[0] += bump;
      p[1] -= bump * 0.7;
    }
  return mesh;
}

template <Element E, template <class> class L, class Q = Full<E>>
Runs manufactured_errors(std::vector<int> const& sizes, Grid grid) {
  using F = Formulation<E, Q, L>;
  return on_meshes(sizes, 2, [&](int n) {
    auto const mesh = unit_grid<E>(n, grid);
    auto body = body_of<F>(mesh, L<double>{manufactured_lambda, manufactured_mu});
    auto exact = mesh.nodes;
    for (auto& p : exact) {
      auto const u = exact_at<E::dim>(p).u;
      for (std::size_t k = 0; k < E::dim; ++k) p[k] = u[static_cast<int>(k)];
    }
    body.set_displacements(exact);
    body.clamp(mesh::outer_sides(mesh));
    body.set_loads(
        body_loads(mesh, [](Point<E::dim> const& X) { return force_needed<L, E::dim>(X); }));
    solve_static(body);
    return errors_of(mesh, body.displacements());
  });
}

/// Rows of one element with one law: on straight and on curved grids, in both norms.
template <Element E, template <class> class L, class Q = Full<E>>
void manufactured_rows(Table& table, std::vector<int> const& sizes) {
  std::string const name = name_of<Formulation<E, Q, L>>();
  for (Grid grid : {Grid::straight, Grid::curved}) {
    std::string const meshes = grid == Grid::straight ? "straight" : "curved";
    auto const runs = manufactured_errors<E, L, Q>(sizes, grid);
    table.converge({"9, error in L2", name, meshes}, runs, 0, E::degree + 1);
    table.converge({"9, error in H1", name, meshes}, runs, 1, E::degree);
  }
}

}  // namespace pliant::verification

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <pliant/mesh/mesh.hpp>

// Arithmetic on values per node.
namespace pliant::test {

template <std::size_t Dim>
using FieldOf = std::vector<std::array<double, Dim>>;

template <std::size_t Dim>
double largest(FieldOf<Dim> const& a) {
  double m = 0;
  for (auto const& v : a)
    for (double x : v) m = std::isfinite(x) ? std::max(m, std::abs(x)) : INFINITY;
  return m;
}
template <std::size_t Dim>
double inner(FieldOf<Dim> const& a, FieldOf<Dim> const& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) sum += a[i][k] * b[i][k];
  return sum;
}
/// a + s b
template <std::size_t Dim>
FieldOf<Dim> plus(FieldOf<Dim> a, double s, FieldOf<Dim> const& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) a[i][k] += s * b[i][k];
  return a;
}
template <std::size_t Dim>
double difference(FieldOf<Dim> const& a, FieldOf<Dim> const& b) {
  return a.size() == b.size() ? largest(plus(a, -1, b)) : NAN;
}
template <std::size_t Dim>
std::array<double, Dim> total(FieldOf<Dim> const& a) {
  std::array<double, Dim> sum{};
  for (auto const& v : a)
    for (std::size_t k = 0; k < Dim; ++k) sum[k] += v[k];
  return sum;
}
/// Σ x × f; in 2D its one component, in the last place.
template <std::size_t Dim>
std::array<double, 3> moment(FieldOf<Dim> const& x, FieldOf<Dim> const& f) {
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    double a[3]{}, b[3]{};
    std::ranges::copy(x[i], a);
    std::ranges::copy(f[i], b);
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  }
  return sum;
}
/// The uniform state u = H X.
template <std::size_t Dim>
FieldOf<Dim> uniform(FieldOf<Dim> const& nodes, Tensor<double, int{Dim}> const& h) {
  FieldOf<Dim> u(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (int i = 0; i < int{Dim}; ++i) {
      u[n][static_cast<std::size_t>(i)] = 0;
      for (int k = 0; k < int{Dim}; ++k)
        u[n][static_cast<std::size_t>(i)] += h(i, k) * nodes[n][static_cast<std::size_t>(k)];
    }
  return u;
}
/// What a body makes of values when it keeps them in single precision.
template <class T, std::size_t Dim>
FieldOf<Dim> rounded(FieldOf<Dim> a) {
  for (auto& v : a)
    for (double& x : v) {
      T volatile kept = static_cast<T>(x);  // GCC 12 drops a rounding to and fro in pairs
      x = static_cast<double>(kept);
    }
  return a;
}

}  // namespace pliant::test

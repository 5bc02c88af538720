#pragma once

#include "support/laws.hpp"

namespace pliant::test {

/// H = F − I.
template <int Dim>
Tensor<double, Dim> gradient_of(Tensor<double, Dim> const& f) {
  return f - Tensor<double, Dim>::identity();
}

/// Random states whose F had one column turned about, shortened too: J < 0.
template <int Dim>
std::vector<Tensor<double, Dim>> inverted_states() {
  std::vector<Tensor<double, Dim>> states;
  Random random(41);
  for (double factor : {-1.0, -0.5, -0.1, -1e-3}) {
    auto f = Tensor<double, Dim>::identity() + random_state<Dim>(random);
    int const column = static_cast<int>(states.size()) % Dim;
    for (int i = 0; i < Dim; ++i) f(i, column) *= factor;
    states.push_back(gradient_of<Dim>(f));
  }
  return states;
}
/// States along the axes with J = 0, to the last bit.
template <int Dim>
std::vector<Tensor<double, Dim>> flat_states() {
  std::vector<Tensor<double, Dim>> states;
  for (std::array<double, 3> stretches :
       {std::array{0.0, 1.0, 1.0}, {1.25, 0.0, 0.75}, {0.0, 0.0, 1.5}, {0.0, 0.0, 0.0}})
    states.push_back(gradient_of<Dim>(diagonal<Dim>(stretches)));
  return states;
}

template <class T, int Dim>
Tensor<T, Dim> in_precision(Tensor<double, Dim> const& h) {
  Tensor<T, Dim> cast;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) cast(i, j) = static_cast<T>(h(i, j));
  return cast;
}

/// How many of some numbers are finite.
inline int count_finite(std::convertible_to<double> auto... x) {
  return (0 + ... + int{std::isfinite(static_cast<double>(x))});
}
template <class T, int Dim>
int count_finite(Tensor<T, Dim> const& a) {
  int count = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) count += count_finite(a(i, j));
  return count;
}

}  // namespace pliant::test

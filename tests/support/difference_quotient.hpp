#pragma once

#include "support/fields.hpp"

namespace pliant::test {

/// df/dx at 0 by central differences with one step of Richardson extrapolation.
template <class Function>
double derivative(Function const& f, double h) {
  return (4 * (f(h / 2) - f(-h / 2)) / h - (f(h) - f(-h)) / (2 * h)) / 3;
}
template <int Dim, class Function>
FieldOf<Dim> field_derivative(Function const& f, double h) {
  FieldOf<Dim> const fine = plus(f(h / 2), -1, f(-h / 2)), coarse = plus(f(h), -1, f(-h));
  return plus(plus(FieldOf<Dim>(fine.size()), 4 / (3 * h), fine), -1 / (6 * h), coarse);
}
template <int Dim, class Function>
Tensor<double, Dim> tensor_derivative(Function const& f, double h) {
  return 4 / (3 * h) * (f(h / 2) - f(-h / 2)) - 1 / (6 * h) * (f(h) - f(-h));
}

}  // namespace pliant::test

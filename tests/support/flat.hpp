#pragma once

#include "support/backends.hpp"
#include "support/fields.hpp"

namespace pliant::test {

/// Values per node as a simulator would keep them: node i at [stride i], what lies between filled
/// with `filler`.
template <class T, std::size_t Dim>
std::vector<T> flat(FieldOf<Dim> const& field, int stride = int{Dim}, double filler = 0) {
  auto const step = static_cast<std::size_t>(stride);
  std::vector<T> values(step * field.size(), static_cast<T>(filler));
  for (std::size_t i = 0; i < field.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) values[step * i + k] = static_cast<T>(field[i][k]);
  return values;
}
template <int Dim, class T>
std::vector<Point<Dim>> per_node(std::vector<T> const& values, int stride = Dim) {
  auto const step = static_cast<std::size_t>(stride);
  std::vector<Point<Dim>> field(values.size() / step);
  for (std::size_t i = 0; i < field.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) field[i][k] = static_cast<double>(values[step * i + k]);
  return field;
}

/// ∂F/∂u du at u.
template <class TheBody>
FieldOf<TheBody::dim> tangent_product(TheBody& body, FieldOf<TheBody::dim> const& u,
                                      FieldOf<TheBody::dim> const& du) {
  using T = typename TheBody::scalar;
  constexpr std::size_t dim = TheBody::dim;
  auto const at = upload(body.backend(), flat<T>(u)), along = upload(body.backend(), flat<T>(du));
  auto f = upload(body.backend(), flat<T>(FieldOf<dim>(u.size())));
  if constexpr (TheBody::has_internal_variables)
    body.add_tangent_product(at.data(), along.data(), f.data(), 1, TheBody::dim, 0);
  else
    body.add_tangent_product(at.data(), along.data(), f.data());
  return per_node<int{dim}>(download<T>(f));
}

}  // namespace pliant::test

#pragma once

#include "adaptation/criteria.hpp"
#include "support/fields.hpp"

namespace pliant::test {

/// The estimates of a body of one formulation that is displaced.
template <class F, class B, class M>
std::vector<double> estimates(B const& backend, M const& mesh,
                              FieldOf<std::size_t{F::dim}> const& u) {
  auto body = body_of<F>(backend, mesh);
  body.set_displacements(u);
  return evaluate<typename F::element>(body, RecoveredStress{});
}
template <std::size_t Dim>
FieldOf<Dim> smooth_field(FieldOf<Dim> const& rest, double size) {
  FieldOf<Dim> u = rest;
  for (auto& p : u) {
    double phase = 0;
    for (std::size_t k = 0; k < Dim; ++k) phase += static_cast<double>(k + 2) * p[k];
    for (std::size_t k = 0; k < Dim; ++k) p[k] = size * std::sin(phase + static_cast<double>(k));
  }
  return u;
}

template <class... Fs, class Visit>
void on_formulations(List<Fs...>, Visit const& visit) {
  (visit(List<Fs>{}), ...);
}

}  // namespace pliant::test

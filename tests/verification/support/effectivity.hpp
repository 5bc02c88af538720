#pragma once

#include <cmath>
#include <cstdio>
#include <string_view>

#include <pliant/adaptation/estimator/recovered_stress.hpp>

#include "verification/support/form.hpp"
#include "verification/support/statics.hpp"

// Estimates of errors beside true ones, in the energy norm.
namespace pliant::verification {

/// The strain energy of a body's error, J: ∫ W(H) − W(H̄) − P(H̄) : (H − H̄) dV, which is ½ ΔH : A : ΔH and
/// smaller, with the exact gradient H̄ = exact(X) and the law law_at(X).
template <Element E, class TheBody, class LawAt, class Exact>
double energy_of_error(TheBody const& body, LawAt const& law_at, Exact const& exact) {
  using Q = Gauss<SimplexCell<typename E::cell> ? 6 : E::degree + 3>;
  static constexpr auto table = tabulate<E, Q, double>();
  auto const& mesh = body.mesh();
  auto const u = body.displacements();
  double sum = 0;
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
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < E::dim; ++k)
          place[static_cast<std::size_t>(k)] += table.shape[q][a] * rest(a, k);
      auto const map = RestMap<E, double>::at(x, table, q);
      Tensor<double, E::dim> const h = map.gradient(v, table, q), answer = exact(place);
      auto const law = law_at(place);
      sum += map.volume * table.weight[q] *
             (energy_density(law, h) - energy_density(law, answer) -
              dot(stress(law, answer), h - answer));
    }
  }
  return sum;
}

/// W − f·u, J, of a body under dead loads.
template <class TheBody, class Loads>
double potential(TheBody const& body, Loads const& loads) {
  double sum = strain_energy(body);
  auto const u = body.displacements();
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < u[i].size(); ++k) sum -= loads[i][k] * u[i][k];
  return sum;
}

/// Prints a row for each body: what is estimated of its error and what the error is, as square roots of
/// energies.
class EffectivityTable {
 public:
  static constexpr double least = 0.5, most = 2;

  EffectivityTable(int argc, char** argv) {
    for (int i = 1; i < argc; ++i)
      if (std::string_view(argv[i]) == "--quick") full_ = false;
    std::printf(
        "\n### Effectivity of RecoveredStress\n\n"
        "Square roots of energies over that of the solution.\n\n"
        "| problem | composition | elements | hanging nodes | estimated error | true error | "
        "effectivity | allowed | |\n|---|---|---|---|---|---|---|---|---|\n");
  }
  bool full() const { return full_; }

  /// `error`: the strain energy of the body's error, J.
  template <class TheBody>
  void row(std::string const& problem, std::string const& composition, TheBody const& body,
           double error, double lowest = least) {
    double const estimated = estimate(body, RecoveredStress{}), scale = strain_energy(body);
    double const effectivity = std::sqrt(estimated / error);
    bool const met = effectivity >= lowest && effectivity <= most;
    std::size_t elements = 0;
    body.parts().for_each_type([&](auto const& table, auto const&) {
      elements += static_cast<std::size_t>(table.count());
    });
    std::printf("| %s | %s | %zu | %zu | %.2e | %.2e | %.2f | %g to %g | %s |\n", problem.c_str(),
                composition.c_str(), elements, body.mesh().slaves.size(),
                std::sqrt(estimated / scale), std::sqrt(error / scale), effectivity, lowest, most,
                met ? "met" : "**missed**");
    std::fflush(stdout);
    ++rows_;
    missed_ += met ? 0 : 1;
  }

  /// 0 when no row was missed.
  int finish() const {
    if (missed_ > 0) std::printf("\n%d of %d rows missed.\n", missed_, rows_);
    return missed_ > 0 || rows_ == 0 ? 1 : 0;
  }

 private:
  bool full_ = has_full_form;
  int rows_ = 0, missed_ = 0;
};

}  // namespace pliant::verification

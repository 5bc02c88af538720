#pragma once

#include "adaptation/migration_suite.hpp"
#include "formulation/force_suite.hpp"
#include "formulation/tangent_suite.hpp"
#include "solver/step_suite.hpp"

// What a change must not slow down: few enough to be timed again and again, in alternation with another
// version of the library, by bench/compare/run. The functions that are timed are each version's own.
namespace pliant::bench {

template <class E, class B>
void compare_element(B const& backend) {
  using T = typename B::scalar;
  using F = Usual<E, SaintVenantKirchhoff>;
  int const cells = usual_cells<E, B>();
  auto const add_one = [&](char const* what, auto run) {
    add<F, T>(what, B::name(), cells, [=](benchmark::State& s) { run(s, backend, cells); });
  };
  add_one("force", [](auto& s, auto const& b, int n) { time_force<F>(s, b, n); });
  add_one("tangent", [](auto& s, auto const& b, int n) { time_tangent_product<F>(s, b, n); });
  add_one("step", [](auto& s, auto const& b, int n) { time_step<F>(s, b, n); });
  add_one("8 steps+check",
          [](auto& s, auto const& b, int n) { time_step_with_checks<E>(s, b, n); });
  add_one("migration", [](auto& s, auto const& b, int n) { time_check<E>(s, b, n, 0.01); });
}

template <template <class> class B>
void add_compared() {
  compare_element<Tet4>(B<float>{});
  compare_element<Tet4>(B<double>{});
  compare_element<Hex8>(B<float>{});
}

}  // namespace pliant::bench

#pragma once

#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// Forces of one element type and law, through the element loop of a backend; zeroing the force array
// is part of the time.
namespace pliant::bench {

template <class F, class B>
void time_force(benchmark::State& state, B const& backend, Problem<B, typename F::element>& p) {
  using E = typename F::element;
  using T = typename B::scalar;
  ForceKernel<GroupLaws<T, F>> const kernel{soft_laws<T, F>()};
  measure(state, backend, [&] {
    p.clear_forces(backend);
    backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u());
  });
  report(state, p, {.read = 2, .written = 1}, 0, flops_per_force<E>());
}
template <class F, class B>
void time_force(benchmark::State& state, B const& backend, int cells) {
  time_force<F>(state, backend, Problem<B, typename F::element>::of(backend, cells));
}

inline void add_forces() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    on_each_formulation([&]<class F>() {
      using E = typename F::element;
      constexpr bool typical = law_number<F>() == 1;
      auto const add_size = [&](int cells) {
        add<F, T>("force", name, cells, [backend, cells](benchmark::State& state) {
          time_force<F>(state, backend, cells);
        });
      };
      if (typical || role != Role::threads) add_size(usual_cells<E, B>());
      if (typical && role == Role::main) add_size(few_cells<E, B>());
      if constexpr (on_gpu<B> && typical && std::same_as<E, Tet4>) add_size(many_cells<E>());
    });
  });
}

}  // namespace pliant::bench

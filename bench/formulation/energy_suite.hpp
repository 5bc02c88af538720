#pragma once

#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// The strain energy, a sum over elements that the host waits for.
namespace pliant::bench {

template <class F, class B>
void time_energy(benchmark::State& state, B const& backend, int cells) {
  using T = typename B::scalar;
  auto& p = Problem<B, typename F::element>::of(backend, cells);
  EnergyKernel<GroupLaws<T, F>> const kernel{soft_laws<T, F>()};
  measure_calls(state, backend, [&] {
    benchmark::DoNotOptimize(backend.template sum_elements<1>(p.elements, kernel, p.rest(), p.u()));
  });
  report(state, p, {.read = 2, .written = 0});
}

inline void add_energies() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    on_each_formulation([&]<class F>() {
      if constexpr (in_pairwise_choice<F, T>())
        if (role == Role::main) {
          int const cells = usual_cells<typename F::element, B>();
          add<F, T>("energy", name, cells, [backend, cells](benchmark::State& state) {
            time_energy<F>(state, backend, cells);
          });
        }
    });
  });
}

}  // namespace pliant::bench

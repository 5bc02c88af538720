#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// The guaranteed stable step of a body, from the stiffness of every element.
namespace pliant::bench {

template <class F, class B>
void time_stable_step(benchmark::State& state, B const& backend, int cells) {
  auto& body = made_once([&] { return shaken_body<F>(backend, cells); });
  measure_calls(state, backend, [&] { benchmark::DoNotOptimize(stable_step(body)); });
  report_elements(state, body);
}

inline void add_stable_steps() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    on_each_formulation([&]<class F>() {
      if constexpr (in_pairwise_choice<F, T>() && law_number<F>() > 0)
        if (role == Role::main) {
          int const cells = usual_cells<typename F::element, B>();
          add<F, T>("stable_step", name, cells, [backend, cells](benchmark::State& state) {
            time_stable_step<F>(state, backend, cells);
          });
        }
    });
  });
}

}  // namespace pliant::bench

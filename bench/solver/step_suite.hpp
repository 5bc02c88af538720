#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Explicit time steps of a body: forces and central differences, replayed by the backend; and eight
// of them with a check of criteria that moves no element.
namespace pliant::bench {

/// Steps of one size, without checks of the state in between.
template <class TheBody>
CentralDifference bare_steps(TheBody& body) {
  return CentralDifference{{.step = 0.3 * stable_step(body),
                            .check_interval = 1 << 30,
                            .refresh_interval = 1 << 30,
                            .watch_interval = 1 << 30}};
}

template <class F, class B>
void time_step(benchmark::State& state, B const& backend, int cells) {
  auto& [body, step] = made_once([&] {
    auto b = shaken_body<F>(backend, cells, 0.1);
    auto s = bare_steps(b);
    return std::pair{std::move(b), s};
  });
  step(body, 4);
  measure_repeats(state, backend, [&b = body, &s = step](int steps) { s(b, steps); });
  report_elements(state, body);
}

/// Under SaintVenantKirchhoff; elements would fall back to Hooke if anything held.
template <class E, class B>
void time_step_with_checks(benchmark::State& state, B const& backend, int cells) {
  using Better = Usual<E, SaintVenantKirchhoff>;
  using Cheaper = Usual<E, Hooke>;
  auto& [body, step] = made_once([&] {
    auto b = shaken_body<Better, Cheaper>(backend, cells, 0.1);
    auto s = bare_steps(b);
    return std::pair{std::move(b), s};
  });
  constexpr int steps_to_check = 8;
  auto adapt = Adaptation{when<Better>(largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{}))
                              .above(1e30)
                              .template become<Cheaper>()}
                   .every(steps_to_check);
  step(body, 4 * steps_to_check, adapt);
  measure_repeats(state, backend,
                  [&, &b = body, &s = step](int times) { s(b, times * steps_to_check, adapt); });
  report_elements(state, body, steps_to_check);
}

inline void add_steps() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role == Role::scalar) return;
    auto const both = [&]<class E>(E, int cells) {
      using F = Usual<E, SaintVenantKirchhoff>;
      add<F, T>("step", name, cells,
                [backend, cells](benchmark::State& state) { time_step<F>(state, backend, cells); });
      add<F, T>("8 steps+check", name, cells, [backend, cells](benchmark::State& state) {
        time_step_with_checks<E>(state, backend, cells);
      });
    };
    constexpr bool single = sizeof(T) == 4;
    both(Tet4{}, usual_cells<Tet4, B>());
    both(Tet4{}, few_cells<Tet4, B>());
    if constexpr (single) both(Hex8{}, usual_cells<Hex8, B>());
    if constexpr (!single) both(Quad4{}, usual_cells<Quad4, B>());
  });
}

}  // namespace pliant::bench

#pragma once

#include <chrono>

#include <benchmark/benchmark.h>

#include <pliant/solve.hpp>

#include "support/backends.hpp"

// Rest, one linear system and implicit steps of a block of Hex8, without a matrix and with one.
namespace pliant::bench {

inline constexpr Elastic block_material{1e5, 0.3, 1000};

template <class F, class B>
auto block(B const& backend, int cells) {
  auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  Body body{backend, mesh, block_material, Group<F>{}};
  body.clamp(mesh.boundary("bottom"));
  return body;
}
/// Runs reset() and then, on the clock, run(); the work of run() is done when it returns.
template <class Reset, class Run>
void time_each(benchmark::State& state, Reset const& reset, Run const& run) {
  run();  // what is made once
  for (auto _ : state) {
    reset();
    auto const start = std::chrono::steady_clock::now();
    run();
    state.SetIterationTime(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
}
template <class TheBody>
void report_unknowns(benchmark::State& state, TheBody const& body) {
  state.counters["unknowns"] = 3.0 * body.nodes();
  state.counters["unknowns_per_second"] =
      benchmark::Counter(3.0 * body.nodes(), benchmark::Counter::kIsIterationInvariantRate);
}

/// Pressed together by a fifth, to a residual of 1e-6: neo-Hooke's law, or one linear system under Hooke's.
template <class F, class B>
void time_rest(benchmark::State& state, B const& backend, int cells, LinearMethod method) {
  auto body = block<F>(backend, cells);
  body.drive(body.mesh().boundary("top"), [](double) { return Point<3>{0, 0, -0.2}; });
  std::vector<Point<3>> const rest(static_cast<std::size_t>(body.nodes()));
  NewtonReport report;
  time_each(
      state, [&] { body.set_displacements(rest); },
      [&] { report = solve_static(body, {.tolerance = 1e-6, .linear = method}); });
  report_unknowns(state, body);
  state.counters["newton"] = report.iterations;
  state.counters["gradients"] = report.linear.iterations;
}
/// Backward Euler at a hundred stable steps, of a block that falls on its clamp.
template <class B>
void time_implicit(benchmark::State& state, B const& backend, int cells, LinearMethod method) {
  auto body = block<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, cells);
  body.set_gravity({0, 0, -10});
  Implicit step{BackwardEuler{},
                {.step = 100 * stable_step(body), .tolerance = 1e-6, .linear = method}};
  ImplicitReport report;
  time_each(
      state, [] {}, [&] { report = step(body); });
  report_unknowns(state, body);
  state.counters["newton"] = report.iterations;
  state.counters["gradients"] = report.linear.iterations;
}

inline void add_without_matrix() {
  using Rubber = Formulation<Hex8, Gauss<2>, NeoHookean>;
  using Linear = Formulation<Hex8, Gauss<2>, Hooke>;
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role == Role::scalar) return;
    using B = std::remove_cvref_t<decltype(backend)>;
    auto const add = [&](std::string const& what, int cells, char const* method, auto const& run) {
      benchmark::RegisterBenchmark(
          (what + "/" + name + "/" + method + "/" + std::to_string(cells)).c_str(), run)
          ->UseManualTime()
          ->Iterations(2)
          ->Unit(benchmark::kMillisecond);
    };
    auto const add_all = [&](int cells, char const* name_of_method, LinearMethod method,
                             bool linear) {
      if (linear)
        add("linear_rest", cells, name_of_method,
            [=](benchmark::State& state) { time_rest<Linear>(state, backend, cells, method); });
      add("rest", cells, name_of_method,
          [=](benchmark::State& state) { time_rest<Rubber>(state, backend, cells, method); });
      add("implicit", cells, name_of_method,
          [=](benchmark::State& state) { time_implicit(state, backend, cells, method); });
    };
    if (on_gpu<B>) {
      for (int cells : {21, 32, 46, 69})
        add_all(cells, "matrix_free", LinearMethod::matrix_free, true);
      add("linear_rest", 148, "matrix_free", [=](benchmark::State& state) {
        time_rest<Linear>(state, backend, 148, LinearMethod::matrix_free);
      });
      add_all(21, "with_matrix", LinearMethod::multilevel, true);
    } else {
      for (int cells : {10, 21}) {
        add_all(cells, "matrix_free", LinearMethod::matrix_free, true);
        add_all(cells, "with_matrix", LinearMethod::multilevel, true);
      }
    }
  });
}

}  // namespace pliant::bench

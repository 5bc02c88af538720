#pragma once

#include <chrono>

#include <benchmark/benchmark.h>

#include <pliant/solve.hpp>

#include "support/backends.hpp"

// Rest, one linear system and implicit steps of a block of Hex8, without a matrix by each preconditioner and with one.
namespace pliant::bench {

inline constexpr Elastic block_material{1e5, 0.3, 1000};

template <class F, class B>
auto block(B const& backend, int cells) {
  auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  Body body{backend, mesh, block_material, Group<F>{}};
  body.clamp(mesh.boundary("bottom"));
  return body;
}
/// How linear systems are solved.
struct Way {
  LinearMethod method;
  Preconditioner preconditioner = Preconditioner::nodal_blocks;
};
/// Runs reset() and then, on the clock, run(), whose work is done when it returns the seconds that do not count: what it
/// took to make preconditioners.
template <class Reset, class Run>
void time_each(benchmark::State& state, Reset const& reset, Run const& run) {
  run();  // what is made once
  for (auto _ : state) {
    reset();
    auto const start = std::chrono::steady_clock::now();
    double const apart = run();
    state.SetIterationTime(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() - apart);
  }
}
template <class TheBody, class Report>
void report_solve(benchmark::State& state, TheBody const& body, Report const& report) {
  state.counters["newton"] = report.iterations;
  state.counters["gradients"] = report.linear.iterations;
  state.counters["matrices"] = report.linear.levels;
  state.counters["setup_ms"] = 1e3 * report.linear.setup;
  state.counters["unknowns"] = 3.0 * body.nodes();
  state.counters["unknowns_per_second"] =
      benchmark::Counter(3.0 * body.nodes(), benchmark::Counter::kIsIterationInvariantRate);
}

/// Pressed together by a fifth, to a residual of 1e-6: neo-Hooke's law, or one linear system under Hooke's.
template <class F, class B>
void time_rest(benchmark::State& state, B const& backend, int cells, Way const& way) {
  auto body = block<F>(backend, cells);
  body.drive(body.mesh().boundary("top"), [](double) { return Point<3>{0, 0, -0.2}; });
  std::vector<Point<3>> const rest(static_cast<std::size_t>(body.nodes()));
  NewtonReport report;
  time_each(
      state, [&] { body.set_displacements(rest); },
      [&] {
        report = solve_static(
            body, {.tolerance = 1e-6, .linear = way.method, .preconditioner = way.preconditioner});
        return report.linear.setup;
      });
  report_solve(state, body, report);
}
/// Backward Euler at a hundred stable steps, of a block that falls on its clamp.
template <class B>
void time_implicit(benchmark::State& state, B const& backend, int cells, Way const& way) {
  auto body = block<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, cells);
  body.set_gravity({0, 0, -10});
  Implicit step{BackwardEuler{},
                {.step = 100 * stable_step(body),
                 .tolerance = 1e-6,
                 .linear = way.method,
                 .preconditioner = way.preconditioner}};
  ImplicitReport report;
  time_each(
      state, [] {},
      [&] {
        report = step(body);
        return report.linear.setup;
      });
  report_solve(state, body, report);
}

inline void add_without_matrix() {
  using Rubber = Formulation<Hex8, Gauss<2>, NeoHookean>;
  using Linear = Formulation<Hex8, Gauss<2>, Hooke>;
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role == Role::scalar) return;
    using B = std::remove_cvref_t<decltype(backend)>;
    auto const add = [&](std::string const& what, int cells, char const* way, auto const& run) {
      benchmark::RegisterBenchmark(
          (what + "/" + name + "/" + way + "/" + std::to_string(cells)).c_str(), run)
          ->UseManualTime()
          ->Iterations(2)
          ->Unit(benchmark::kMillisecond);
    };
    auto const add_linear = [&](int cells, char const* name_of_way, Way const& way) {
      add("linear_rest", cells, name_of_way,
          [=](benchmark::State& state) { time_rest<Linear>(state, backend, cells, way); });
    };
    auto const add_all = [&](int cells, char const* name_of_way, Way const& way) {
      add_linear(cells, name_of_way, way);
      add("rest", cells, name_of_way,
          [=](benchmark::State& state) { time_rest<Rubber>(state, backend, cells, way); });
      add("implicit", cells, name_of_way,
          [=](benchmark::State& state) { time_implicit(state, backend, cells, way); });
    };
    constexpr auto without = LinearMethod::matrix_free;
    std::vector<int> const sizes = on_gpu<B> ? std::vector{21, 46, 69} : std::vector{10, 21, 32};
    for (int cells : sizes) {
      add_all(cells, "nodal_blocks", {without, Preconditioner::nodal_blocks});
      add_linear(cells, "chebyshev", {without, Preconditioner::chebyshev});
      add_all(cells, "multigrid", {without, Preconditioner::multigrid});
    }
    if (on_gpu<B>) {
      add_linear(148, "nodal_blocks", {without, Preconditioner::nodal_blocks});
      add_linear(148, "chebyshev", {without, Preconditioner::chebyshev});
      add_linear(148, "multigrid", {without, Preconditioner::multigrid});
    }
    add_all(21, "with_matrix", {LinearMethod::multilevel});
    if (!on_gpu<B>) add_all(10, "with_matrix", {LinearMethod::multilevel});
  });
}

}  // namespace pliant::bench

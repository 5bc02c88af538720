#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// What stands before the first step: making a mesh, checking it, making a body of it.
namespace pliant::bench {

/// As it is generated: a cube of equal cells.
template <class E>
Mesh<E> cube(int cells) {
  return mesh::box<E>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
}

template <class E, class B, class Work>
void time_set_up(benchmark::State& state, B const& backend, int cells, Work const& work) {
  auto const on_its_threads = [&] {
    HostThreads const threads(backend);
    work();
  };
  for (auto _ : state) state.SetIterationTime(seconds(backend, on_its_threads));
  auto const elements = static_cast<double>(element_count<E>(cells));
  state.counters["elements"] = elements;
  report_rate(state, "items_per_second", elements);
}

inline void add_set_ups() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    auto const one = [&]<class E>(E, double elements) {
      using F = Usual<E, SaintVenantKirchhoff>;
      int const cells = cells_for<E>(elements);
      add<F, T>("mesh", name, cells, [=](benchmark::State& state) {
        time_set_up<E>(state, backend, cells, [&] { cube<E>(cells); });
      });
      add<F, T>("check", name, cells, [=](benchmark::State& state) {
        auto const mesh = cube<E>(cells);
        time_set_up<E>(state, backend, cells, [&] { check(mesh); });
      });
      add<F, T>("body", name, cells, [=](benchmark::State& state) {
        auto const mesh = cube<E>(cells);
        time_set_up<E>(state, backend, cells, [&] { Body{backend, mesh, soft, Group<F>{}}; });
      });
    };
    one(Tet4{}, 1e6);
    one(Hex8{}, 2e5);
    one(Tet10{}, 1e5);
    one(Hex27{}, 3e4);
    one(Tet4{}, 6e3);
  });
}

}  // namespace pliant::bench

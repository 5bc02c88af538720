#pragma once

#include <malloc.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "support/bodies.hpp"
#include "support/registration.hpp"

#if defined(__CUDACC__)
#include <cuda_runtime.h>
#endif

// What bodies hold in memory after some explicit steps, per element and per node: by themselves, and with what adaptation adds.
// The time is that of making the body.
namespace pliant::bench {

/// What the program has asked of the host's allocator, in bytes.
inline double host_bytes() {
  auto const use = mallinfo2();
  return static_cast<double>(use.uordblks) + static_cast<double>(use.hblkhd);
}
/// What is taken of the GPU's memory, in bytes: what arrays take of the device's pool, which holds more, and what else is
/// taken, as kernels do for what their threads keep.
inline double device_bytes() {
#if defined(__CUDACC__)
  std::size_t free = 0, total = 0;
  cudaMemGetInfo(&free, &total);
  int device = 0;
  cudaGetDevice(&device);
  cudaMemPool_t pool = nullptr;
  cudaDeviceGetDefaultMemPool(&pool, device);
  std::uint64_t reserved = 0, used = 0;
  cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &reserved);
  cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used);
  return static_cast<double>(total - free) - static_cast<double>(reserved) +
         static_cast<double>(used);
#else
  return 0;
#endif
}

enum class With { nothing, two_laws, looks, sleep };

template <class F, class B>
void measure_memory(benchmark::State& state, B const& backend, int cells, With with) {
  using E = typename F::element;
  using Cheap = Usual<E, Hooke>;
  auto const run = [&](auto const&... groups) {
    auto mesh = mesh_of<E>(cells);
    auto const elements = static_cast<double>(mesh.template elements<E>().size()),
               nodes = static_cast<double>(mesh.nodes.size());
    double const host = host_bytes(), device = device_bytes();
    double const time = seconds(backend, [] {});
    double made = 0;
    {
      std::optional<decltype(Body{backend, mesh, soft, groups...})> body;
      made = seconds(backend, [&] { body.emplace(backend, std::move(mesh), soft, groups...); });
      auto const own =
          static_cast<double>(nodes * sizeof(Point<E::dim>) + elements * sizeof(Connectivity<E>));
      CentralDifference step;
      if constexpr (sizeof...(groups) > 1) {
        if (with == With::looks) {
          Adaptation adapt{when<F>(StrainNorm{}).above(1e30).template become<Cheap>()};
          step(*body, 16, adapt);
        } else {
          step(*body, 16);
        }
      } else if (with == With::sleep) {
        Adaptation adapt{sleep({.below = 1e-3, .for_steps = 16})};
        auto v = body->velocities();
        for (std::size_t i = 0; i < v.size() / 2; ++i) v[i][0] = 0.01 * std::sin(double(i));
        body->set_velocities(v);
        v = {};
        step(*body, 64, adapt);
      } else {
        step(*body, 16);
      }
      malloc_trim(0);
      double const taken = host_bytes() - host + own;  // the mesh was moved into the body
      state.counters["host bytes/element"] = taken / elements;
      state.counters["device bytes/element"] = (device_bytes() - device) / elements;
      state.counters["host bytes/node"] = taken / nodes;
      state.counters["device bytes/node"] = (device_bytes() - device) / nodes;
      state.counters["elements"] = elements;
    }
    for (auto _ : state) state.SetIterationTime(made - time);
  };
  if (with == With::two_laws || with == With::looks)
    run(Group<F>{}, Group<Cheap>{});
  else
    run(Group<F>{});
}

inline void add_memory() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const of = [&]<class E>(E, double elements, char const* what, With with) {
      using F = Usual<E, SaintVenantKirchhoff>;
      int const cells = cells_for<E>(elements);
      add_once<F, T>(what, name, cells, [backend, cells, with](benchmark::State& state) {
        measure_memory<F>(state, backend, cells, with);
      });
    };
    double const many = on_gpu<B> ? 8e6 : 2e5;
    auto const alone = [&]<class E>(E) { of(E{}, 4 * many / E::nodes, "body", With::nothing); };
    alone(Tri3{}), alone(Quad4{}), alone(Tri6{}), alone(Quad9{});
    alone(Tet4{}), alone(Hex8{}), alone(Tet10{}), alone(Hex27{});
    of(Tet4{}, many, "body of two laws", With::two_laws);
    of(Tet4{}, many, "body of two laws that looks", With::looks);
    of(Tet4{}, many, "body that sleeps", With::sleep);
    if constexpr (on_gpu<B> && sizeof(T) == 4) of(Tet4{}, 1e8, "large body", With::nothing);
  });
}

}  // namespace pliant::bench

#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Steps of a body of which a share is awake: two boxes apart in one mesh, of which the smaller one swings.
namespace pliant::bench {

using Swinging = Usual<Tet4, SaintVenantKirchhoff>;

/// Boxes of n³ cells and of n² times as many as make the share that swings.
template <class B>
auto two_boxes(B const& backend, int n, double share) {
  auto const layers = std::max(1, static_cast<int>(std::lround(n * share)));
  double const edge = 1.0 / n;
  auto mesh = mesh::box<Tet4>({.size = {1, 1, edge * (n - layers)}, .cells = {n, n, n - layers}});
  auto const other = mesh::box<Tet4>({.size = {1, 1, edge * layers}, .cells = {n, n, layers}});
  auto const first = static_cast<Index>(mesh.nodes.size());
  for (auto p : other.nodes) mesh.nodes.push_back({p[0], p[1], p[2] - 1});
  for (auto element : other.template elements<Tet4>()) {
    for (Index& node : element) node += first;
    mesh.template elements<Tet4>().push_back(element);
  }
  Body body{backend, mesh, soft, Group<Swinging>{}};
  auto v = body.velocities();
  for (auto i = static_cast<std::size_t>(first); i < v.size(); ++i)
    v[i] = {0.05 * std::cos(3.14159265 * mesh.nodes[i][1]), 0.02 * (mesh.nodes[i][0] - 0.5), 0};
  body.set_velocities(v);
  return body;
}

/// 64 steps in one call, with a look after every eighth where patches may sleep.
template <class B>
void time_steps(benchmark::State& state, B const& backend, int cells, double share, bool sleeps) {
  auto& [body, step] = made_once([&] {
    auto b = two_boxes(backend, cells, share);
    CentralDifference s;
    s(b, 8);
    return std::pair{std::move(b), s};
  });
  Adaptation adapt{sleep({.below = 1e-3, .for_steps = 16})};
  constexpr int steps = 64;
  if (sleeps) step(body, steps, adapt);
  measure_calls(state, backend, [&, &b = body, &s = step] {
    if (sleeps)
      s(b, steps, adapt);
    else
      s(b, steps);
  });
  report_elements(state, body, steps);
  auto const found = asleep(body);
  state.counters["awake"] =
      sleeps ? 1 - static_cast<double>(found.patches) / std::max(found.of_patches, 1) : 1;
}

/// The forces of the patches that are awake.
template <class B>
void time_awake_forces(benchmark::State& state, B const& backend, int cells, double share) {
  auto& body = made_once([&] {
    auto b = two_boxes(backend, cells, share);
    CentralDifference step;
    Adaptation adapt{sleep({.below = 1e-3, .for_steps = 16})};
    step(b, 64, adapt);
    return b;
  });
  measure(state, backend, [&] {
    forget_forces(body.parts());
    evaluate_forces(body.parts());
  });
  report_elements(state, body);
}

inline void add_sleep() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role == Role::scalar) return;
    auto const of_size = [&](int cells) {
      auto const add_one = [&](char const* what, auto run) {
        add<Swinging, T>(what, name, cells,
                         [backend, cells, run](benchmark::State& s) { run(s, backend, cells); });
      };
      add_one("steps, all awake",
              [](auto& s, auto const& b, int n) { time_steps(s, b, n, 0.1, false); });
      add_one("steps, 0.1 awake",
              [](auto& s, auto const& b, int n) { time_steps(s, b, n, 0.1, true); });
      add_one("steps, 0.01 awake",
              [](auto& s, auto const& b, int n) { time_steps(s, b, n, 0.01, true); });
      add_one("force, 0.1 awake",
              [](auto& s, auto const& b, int n) { time_awake_forces(s, b, n, 0.1); });
    };
    if constexpr (on_gpu<B> == (sizeof(T) == 4)) {
      of_size(usual_cells<Tet4, B>());
      if constexpr (on_gpu<B>) of_size(cells_for<Tet4>(1e7));
    }
  });
}

}  // namespace pliant::bench

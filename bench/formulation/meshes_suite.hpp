#pragma once

#include <array>
#include <cstdlib>

#include "formulation/force_suite.hpp"
#include "formulation/tangent_suite.hpp"
#include "support/delaunay.hpp"

// Forces over the size of boxes, and forces and tangent products of a Delaunay mesh in random order beside a box.
namespace pliant::bench {

/// A problem, or why there is none.
template <Backend B, Element E>
struct Attempt {
  std::shared_ptr<Problem<B, E>> problem{};
  std::string failure{};
};

/// Calls time(problem) with that of make_mesh(), an OrderedMesh. It is kept until the next benchmark begins; where there
/// is too little memory the benchmark says so and is left out.
template <Element E, class B, class MakeMesh, class Time>
void time_kept(benchmark::State& state, B const& backend, MakeMesh const& make_mesh,
               Time const& time) {
  auto const& attempt = made_once([&]() -> Attempt<B, E> {
    try {
      HostThreads const threads;
      return {.problem = std::make_shared<Problem<B, E>>(backend, make_mesh())};
    } catch (std::exception const& error) {
      return {.failure = error.what()};
    }
  });
  if (attempt.problem)
    time(*attempt.problem);
  else
    state.SkipWithError(attempt.failure.c_str());
}

/// Of boxes of about 10 to the power of `digits` elements.
template <class F>
void add_force_of_size(int digits) {
  using E = typename F::element;
  int const cells = cells_for<E>(std::pow(10., digits));
  on_each_backend_and_precision([&](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role == Role::scalar || (digits > 7 && !(on_gpu<B> && sizeof(T) == 4))) return;
    add<F, T>("force at 1e" + std::to_string(digits), name, cells,
              [backend, cells](benchmark::State& state) {
                time_kept<E>(
                    state, backend, [&]() -> auto const& { return OrderedMesh<E>::of(cells); },
                    [&](auto& problem) { time_force<F>(state, backend, problem); });
              });
  });
}

/// `kind`: what the mesh is, in the names.
inline void add_force_and_tangent_of(std::string const& kind, Mesh<Tet4> mesh) {
  using F = Usual<Tet4, SaintVenantKirchhoff>;
  auto const elements = static_cast<long>(mesh.elements<Tet4>().size());
  auto const ordered = std::make_shared<OrderedMesh<Tet4> const>(std::move(mesh));
  on_each_backend_and_precision([&](auto const& backend, std::string const& name, Role role) {
    using T = typename std::remove_cvref_t<decltype(backend)>::scalar;
    if (role != Role::main) return;
    auto const add_one = [&](std::string const& what, auto const& time) {
      add_named(name_of_mesh<F, T>(what + " of " + kind, name, elements),
                [ordered, backend, time](benchmark::State& state) {
                  time_kept<Tet4>(
                      state, backend, [&]() -> auto const& { return *ordered; },
                      [&](auto& problem) { time(state, backend, problem); });
                });
    };
    add_one("force", [](auto& state, auto const& b, auto& p) { time_force<F>(state, b, p); });
    add_one("tangent",
            [](auto& state, auto const& b, auto& p) { time_tangent_product<F>(state, b, p); });
  });
}

/// Of the mesh that PLIANT_DELAUNAY names in the environment, and of a box of about as many elements.
inline void add_delaunay_beside_box() {
  char const* const file = std::getenv("PLIANT_DELAUNAY");
  if (file == nullptr || *file == '\0') {
    std::fprintf(
        stderr,
        "unstructured meshes are left out: PLIANT_DELAUNAY names no file of bench/delaunay\n");
    return;
  }
  auto mesh = read_delaunay(file);
  auto const elements = static_cast<double>(mesh.elements<Tet4>().size());
  add_force_and_tangent_of("Delaunay", std::move(mesh));
  add_force_and_tangent_of("box", mesh_of<Tet4>(cells_for<Tet4>(elements)));
}

inline void add_meshes() {
  add_delaunay_beside_box();
  for (int digits : {4, 5, 6, 7, 8}) {
    add_force_of_size<Usual<Tet4, SaintVenantKirchhoff>>(digits);
    add_force_of_size<Usual<Hex8, SaintVenantKirchhoff>>(digits);
  }
}

}  // namespace pliant::bench

#pragma once

#include "formulation/force_suite.hpp"
#include "formulation/tangent_suite.hpp"
#include "support/program.hpp"

// Forces and tangent products of the elements that force_bench and tangent_bench leave out.
namespace pliant::bench {

template <Element E>
void add_to_catalogue() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    int const cells = usual_cells<E, B>();
    auto const both = [&]<class F>() {
      add<F, T>("force", name, cells, [backend, cells](benchmark::State& state) {
        time_force<F>(state, backend, cells);
      });
      add<F, T>("tangent", name, cells, [backend, cells](benchmark::State& state) {
        time_tangent_product<F>(state, backend, cells);
      });
    };
    both.template operator()<Usual<E, SaintVenantKirchhoff>>();
    both.template operator()<Usual<E, NeoHookean>>();
  });
}

template <Element... E>
int run_catalogue(int argc, char** argv) {
  return run(argc, argv, [] { (add_to_catalogue<E>(), ...); });
}

}  // namespace pliant::bench

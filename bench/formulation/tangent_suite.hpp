#pragma once

#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// The product of the tangent with a displacement, matrix-free, at a displacement; zeroing the result
// is part of the time.
namespace pliant::bench {

template <class F, class B>
void time_tangent_product(benchmark::State& state, B const& backend,
                          Problem<B, typename F::element>& p) {
  using T = typename B::scalar;
  TangentKernel<T, GroupLaws<T, F>> const kernel{soft_laws<T, F>(), T(1)};
  measure(state, backend, [&] {
    p.clear_forces(backend);
    backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u(), p.du());
  });
  report(state, p, {.read = 3, .written = 1});
}
template <class F, class B>
void time_tangent_product(benchmark::State& state, B const& backend, int cells) {
  time_tangent_product<F>(state, backend, Problem<B, typename F::element>::of(backend, cells));
}

/// Pairwise, and what peers publish in full: solids under nonlinear laws.
template <class F, class T>
constexpr bool tangent_is_timed() {
  return in_pairwise_choice<F, T>() || (F::dim == 3 && law_number<F>() > 0);
}

inline void add_tangent_products() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    on_each_formulation([&]<class F>() {
      using E = typename F::element;
      constexpr bool typical = law_number<F>() == 1;
      if constexpr (tangent_is_timed<F, T>()) {
        auto const add_size = [&](int cells) {
          add<F, T>("tangent", name, cells, [backend, cells](benchmark::State& state) {
            time_tangent_product<F>(state, backend, cells);
          });
        };
        if (typical || role == Role::main) add_size(usual_cells<E, B>());
        if constexpr (on_gpu<B> && typical && std::same_as<E, Tet4>) {
          add_size(few_cells<E, B>());
          add_size(many_cells<E>());
        }
      }
    });
  });
}

}  // namespace pliant::bench

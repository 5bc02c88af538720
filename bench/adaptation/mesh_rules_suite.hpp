#pragma once

#include <cmath>
#include <tuple>
#include <type_traits>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Looks of rules that change meshes: with the change, of a share that a rule refines or coarsens, and without, of a mesh that
// is held by a budget, beside the forces of its elements and what the estimator takes.
namespace pliant::bench {

/// Elements whose middle is in a slab of so much of the unit cube.
template <class F, class B>
void time_rule(benchmark::State& state, B const& backend, int cells, double share, bool back) {
  constexpr int dim = F::dim;
  auto body = shaken_body<F>(backend, cells);
  Vector<double, dim> low, high;
  for (int k = 0; k < dim; ++k) low[k] = -10, high[k] = 10;
  high[0] = share;
  auto const in_slab = inside(EdgeLengthRatio{}, Box<dim>{low, high});
  Adaptation there{when<F>(in_slab).above(-1).refine({.max_level = 1})};
  Adaptation again{when<F>(in_slab).above(-1).coarsen()};
  report_elements(state, body);
  auto const change = [&] {
    double const first = seconds(backend, [&] { there.now(body); });
    double const second = seconds(backend, [&] { again.now(body); });
    return back ? second : first;
  };
  change();
  for (auto _ : state) state.SetIterationTime(change());
}

enum class Held { look, estimate, forces };

/// A mesh around a bump, which looks no longer change.
template <class F, class B>
void time_held(benchmark::State& state, B const& backend, int cells, Held what) {
  using E = typename F::element;
  auto& [body, adapt] = made_once([&] {
    auto made = shaken_body<F>(backend, cells, 0);
    auto const bump = [&made] {
      auto u = made.mesh().nodes;
      for (auto& p : u) {
        double apart = 0;
        for (double x : p) apart += square(x - 0.4);
        p = {};
        p[0] = 0.01 * std::exp(-apart / square(0.2));
      }
      made.set_displacements(u);
    };
    Adaptation held{
        within<F>(RecoveredStress{},
                  {.evaluations_per_step = 1.3 * static_cast<double>(element_count<E>(cells)),
                   .max_level = 1})};
    for (int look = 0; look < 6; ++look) {
      bump();
      held.now(made);
    }
    return std::tuple{std::move(made), std::move(held)};
  });
  report_elements(state, body);
  auto const count = [&b = body] { return std::get<0>(b.parts().layout.tables).count(); };
  double changed = 0;
  auto const once = [&, &b = body, &a = adapt] {
    auto const before = count();
    if (what == Held::look) {
      a.now(b);
    } else if (what == Held::estimate) {
      (void)estimate(b, RecoveredStress{});
    } else {
      forget_forces(b.parts());
      evaluate_forces(b.parts());
    }
    changed += std::abs(static_cast<double>(count() - before));
  };
  once();
  changed = 0;
  for (auto _ : state) state.SetIterationTime(seconds(backend, once));
  state.counters["changed"] = changed;
}

inline void add_mesh_rules() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E>(E, double elements) {
      using F = Usual<E, SaintVenantKirchhoff>;
      int const cells = cells_for<E>(elements);
      for (auto const& [share, words] : {std::pair{0.1, "a tenth"}, {0.01, "a hundredth"}})
        for (bool const back : {false, true})
          add<F, T>(
              (back ? "coarsen " : "refine ") + std::string(words) + " by a rule", name, cells,
              [=](benchmark::State& state) { time_rule<F>(state, backend, cells, share, back); });
      for (auto const& [what, words] : {std::pair{Held::look, "look of a mesh that is held"},
                                        {Held::estimate, "estimate the errors of such a mesh"},
                                        {Held::forces, "forces of such a mesh"}})
        add<F, T>(words, name, cells,
                  [=](benchmark::State& state) { time_held<F>(state, backend, cells, what); });
    };
    one(Tet4{}, 2e4);
    one(Tet4{}, 1e6);
  });
}

}  // namespace pliant::bench

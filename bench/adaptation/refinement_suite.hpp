#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Refinement of a tenth of a plane mesh: new nodes, hanging nodes, state, layout and groups. The rate
// counts the elements before.
namespace pliant::bench {

template <class E, class B>
void time_refinement(benchmark::State& state, B const& backend, int cells) {
  auto const fresh = [&] { return shaken_body<Usual<E, SaintVenantKirchhoff>>(backend, cells); };
  std::vector<Index> marked;
  for (Index e = 0; e < static_cast<Index>(element_count<E>(cells) / 10); ++e) marked.push_back(e);
  for (auto _ : state) {
    auto body = fresh();
    state.SetIterationTime(seconds(backend, [&] { refine(body, {marked}); }));
  }
  auto body = fresh();
  report_elements(state, body);
}

inline void add_refinements() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E>(E) {
      int const cells = cells_for<E>(2e4);
      add<Usual<E, SaintVenantKirchhoff>, T>(
          "refine", name, cells,
          [backend, cells](benchmark::State& state) { time_refinement<E>(state, backend, cells); });
    };
    one(Tri3{});
    one(Quad4{});
  });
}

}  // namespace pliant::bench

#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Changes of the mesh: new nodes, hanging nodes, state, layout and groups. The rate counts the elements before.
namespace pliant::bench {

/// The first elements of a mesh.
inline std::vector<Index> first_elements(std::size_t count) {
  std::vector<Index> marked;
  for (std::size_t e = 0; e < count; ++e) marked.push_back(static_cast<Index>(e));
  return marked;
}

/// Elements all over a mesh: each of so many.
inline std::vector<Index> each_of(std::size_t elements, Index distance) {
  std::vector<Index> marked;
  for (Index e = 0; e < static_cast<Index>(elements); e += distance) marked.push_back(e);
  return marked;
}

/// A tenth of a mesh that nobody has refined, whose refinement tree is made too.
template <class E, class B>
void time_refinement(benchmark::State& state, B const& backend, int cells) {
  auto const fresh = [&] { return shaken_body<Usual<E, SaintVenantKirchhoff>>(backend, cells); };
  auto const marked = first_elements(element_count<E>(cells) / 10);
  for (auto _ : state) {
    auto body = fresh();
    state.SetIterationTime(seconds(backend, [&] { refine(body, {marked}); }));
  }
  auto body = fresh();
  report_elements(state, body);
}

/// Some elements of a mesh in which one was refined before, or what that made of them back to what they were. `acted`: there is
/// a pressure at its top, and its right end is driven.
template <class E, class B>
void time_change(benchmark::State& state, B const& backend, int cells,
                 std::vector<Index> const& marked, bool back, bool acted) {
  auto body = shaken_body<Usual<E, SaintVenantKirchhoff>>(backend, cells);
  report_elements(state, body);
  if (acted) {
    body.press(body.mesh().boundary("top"), 10);
    body.drive(body.mesh().boundary("right"), [](double time) {
      Point<E::dim> u{};
      u[0] = time;
      return u;
    });
  }
  auto const last = static_cast<Index>(element_count<E>(cells)) - 1;
  auto const children = [&] {
    std::vector<Index> found;
    auto const levels = refinement_levels<E>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] > 0) found.push_back(static_cast<Index>(e));
    return found;
  };
  for (auto _ : state) {
    refine(body, {{last}});
    double const there = seconds(backend, [&] { refine(body, {marked}); });
    auto const made = children();
    double const again = seconds(backend, [&] { coarsen(body, {made}); });
    state.SetIterationTime(back ? again : there);
  }
}

inline void add_refinements() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E>(E, double elements) {
      int const cells = cells_for<E>(elements);
      add<Usual<E, SaintVenantKirchhoff>, T>(
          "refine", name, cells,
          [backend, cells](benchmark::State& state) { time_refinement<E>(state, backend, cells); });
      auto const change = [&](std::string const& what, std::vector<Index> const& marked,
                              bool acted = false) {
        for (bool const back : {false, true})
          add<Usual<E, SaintVenantKirchhoff>, T>(
              (back ? "coarsen " : "refine ") + what + (acted ? ", pressed and driven" : ""), name,
              cells, [=](benchmark::State& state) {
                time_change<E>(state, backend, cells, marked, back, acted);
              });
      };
      std::size_t const count = element_count<E>(cells);
      change("two", first_elements(2));
      change("a tenth", first_elements(count / 10));
      if (elements < 1e6) return;
      change("a ten thousandth", first_elements(count / 10000));
      change("a hundredth", first_elements(count / 100));
      change("each hundredth", each_of(count, 100));
      change("two", first_elements(2), true);
      change("each hundredth", each_of(count, 100), true);
      change("a tenth", first_elements(count / 10), true);
    };
    one(Tri3{}, 2e4);
    one(Quad4{}, 2e4);
    one(Tet4{}, 2e4);
    one(Hex8{}, 2e4);
    one(Tet4{}, 1e6);
  });
}

}  // namespace pliant::bench

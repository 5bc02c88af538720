#pragma once

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <pliant/mesh/with_types.hpp>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Elements that are split into such of another shape, and merged, and changes of a mesh beside them, beside the forces of its elements.
// The rate counts the elements.
namespace pliant::bench {

enum class OfShapes { split, merge, refine, coarsen, forces };

template <class E>
using OneLaw = Usual<E, SaintVenantKirchhoff>;

template <class B>
auto body_of_shapes(B const& backend, Mesh<Quad4> const& mesh) {
  return Body{backend, mesh::with_types<Quad4, Tri3>(mesh), soft, Group<OneLaw<Quad4>>{},
              Group<OneLaw<Tri3>>{}};
}
template <class B>
auto body_of_shapes(B const& backend, Mesh<Hex8> const& mesh) {
  return Body{backend,
              mesh::with_types<Hex8, Pyramid5, Tet4>(mesh),
              soft,
              Group<OneLaw<Hex8>>{},
              Group<OneLaw<Pyramid5>>{},
              Group<OneLaw<Tet4>>{}};
}

/// Splits, of so many elements, one in `distance`, and merges them; or refines two of those into which these are split.
template <class E, class B>
void time_shapes(benchmark::State& state, B const& backend, int cells, Index first, Index distance,
                 OfShapes what) {
  auto const mesh = mesh_of<E>(cells);
  auto body = body_of_shapes(backend, mesh);
  constexpr std::size_t types = std::tuple_size_v<decltype(body.parts().layout.tables)>;
  body.clamp(mesh.boundary("left"));
  body.set_displacements(shaken(mesh.nodes, 1, 1));
  report_elements(state, body);
  std::vector<std::vector<Index>> whole(types), two_parts(types);
  for (Index e = 0; e < first; e += distance) whole[0].push_back(e);
  two_parts[1] = {0, 1};
  auto const all_parts = [&] {
    std::vector<std::vector<Index>> marked(types);
    Index const count = std::get<1>(body.parts().layout.tables).count();
    for (Index e = 0; e < count; ++e) marked[1].push_back(e);
    return marked;
  };
  split(body, whole);  // with what only the first change makes
  if (what == OfShapes::split || what == OfShapes::merge) {
    auto const made = all_parts();
    merge(body, made);
    for (auto _ : state) {
      double const there = seconds(backend, [&] { split(body, whole); });
      double const again = seconds(backend, [&] { merge(body, made); });
      state.SetIterationTime(what == OfShapes::split ? there : again);
    }
  } else if (what == OfShapes::forces) {
    for (auto _ : state)
      state.SetIterationTime(seconds(backend, [&] {
        forget_forces(body.parts());
        evaluate_forces(body.parts());
      }));
  } else {
    refine(body, two_parts);
    std::vector<std::vector<Index>> made(types);
    std::size_t type = 0;
    body.parts().for_each_type([&](auto const& table, auto const&) {
      using F = typename std::remove_cvref_t<decltype(table)>::element;
      auto const levels = refinement_levels<F>(body);
      for (std::size_t e = 0; e < levels.size(); ++e)
        if (levels[e] > 0) made[type].push_back(static_cast<Index>(e));
      ++type;
    });
    coarsen(body, made);
    for (auto _ : state) {
      double const there = seconds(backend, [&] { refine(body, two_parts); });
      double const again = seconds(backend, [&] { coarsen(body, made); });
      state.SetIterationTime(what == OfShapes::refine ? there : again);
    }
  }
}

inline void add_shapes() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using T = typename std::remove_cvref_t<decltype(backend)>::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E>(E, double elements) {
      int const cells = cells_for<E>(elements);
      auto const count = static_cast<Index>(element_count<E>(cells));
      auto const add_one = [&](std::string const& words, Index first, Index distance,
                               OfShapes what) {
        add<OneLaw<E>, T>(words, name, cells, [=](benchmark::State& state) {
          time_shapes<E>(state, backend, cells, first, distance, what);
        });
      };
      for (auto const& [words, first, distance] : {std::tuple{"two", Index{2}, Index{1}},
                                                   {"each hundredth", count, Index{100}},
                                                   {"a tenth", count / 10, Index{1}}}) {
        add_one(std::string("split ") + words, first, distance, OfShapes::split);
        add_one(std::string("merge ") + words, first, distance, OfShapes::merge);
      }
      add_one("refine two parts where a tenth is split", count / 10, 1, OfShapes::refine);
      add_one("coarsen two parts where a tenth is split", count / 10, 1, OfShapes::coarsen);
      add_one("forces where a tenth is split", count / 10, 1, OfShapes::forces);
    };
    one(Quad4{}, 1e6);
    one(Hex8{}, 2e4);
    one(Hex8{}, 2e5);
  });
}

}  // namespace pliant::bench

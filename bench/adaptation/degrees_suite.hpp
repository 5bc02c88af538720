#pragma once

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <pliant/mesh/with_types.hpp>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Elements that get another degree, and back, and changes of a mesh of both degrees, beside the forces of its elements. The rate
// counts the elements.
namespace pliant::bench {

enum class OfDegrees { raise, lower, refine, coarsen, forces };

/// All elements of a type; one in so many of the first ones.
inline std::vector<Index> some_elements(Index count, Index distance = 1) {
  std::vector<Index> marked;
  for (Index e = 0; e < count; e += distance) marked.push_back(e);
  return marked;
}

/// Raises, of so many linear elements, one in `distance`, and lowers them; or refines two others beside them.
template <class E, class F, class B>
void time_degrees(benchmark::State& state, B const& backend, int cells, Index first, Index distance,
                  OfDegrees what) {
  auto const mesh = mesh::with_types<E, F>(mesh_of<E>(cells));
  Body body{backend, mesh, soft, Group<Usual<E, SaintVenantKirchhoff>>{},
            Group<Usual<F, SaintVenantKirchhoff>>{}};
  body.clamp(mesh.boundary("left"));
  body.set_displacements(shaken(mesh.nodes, 1, 1));
  report_elements(state, body);
  std::vector<std::vector<Index>> const raised{some_elements(first, distance), {}};
  auto const lowered = [&] {
    return std::vector<std::vector<Index>>{
        {}, some_elements(std::get<1>(body.parts().layout.tables).count())};
  };
  std::vector<std::vector<Index>> const refined{some_elements(2), {}};
  auto const children = [&] {
    std::vector<std::vector<Index>> found{{}, {}};
    auto const levels = refinement_levels<E>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] > 0) found[0].push_back(static_cast<Index>(e));
    return found;
  };
  raise(body, raised);  // with what only the first change makes
  auto const all = lowered();
  if (what == OfDegrees::raise || what == OfDegrees::lower) {
    lower(body, all);
    for (auto _ : state) {
      double const there = seconds(backend, [&] { raise(body, raised); });
      double const again = seconds(backend, [&] { lower(body, all); });
      state.SetIterationTime(what == OfDegrees::raise ? there : again);
    }
  } else if (what == OfDegrees::forces) {
    for (auto _ : state)
      state.SetIterationTime(seconds(backend, [&] {
        forget_forces(body.parts());
        evaluate_forces(body.parts());
      }));
  } else {
    refine(body, refined);
    auto const made = children();
    coarsen(body, made);
    for (auto _ : state) {
      double const there = seconds(backend, [&] { refine(body, refined); });
      double const again = seconds(backend, [&] { coarsen(body, made); });
      state.SetIterationTime(what == OfDegrees::refine ? there : again);
    }
  }
}

inline void add_degrees() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using T = typename std::remove_cvref_t<decltype(backend)>::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E, class F>(E, F, double elements) {
      int const cells = cells_for<E>(elements);
      auto const count = static_cast<Index>(element_count<E>(cells));
      auto const add_one = [&](std::string const& words, Index first, Index distance,
                               OfDegrees what) {
        add<Usual<E, SaintVenantKirchhoff>, T>(words, name, cells, [=](benchmark::State& state) {
          time_degrees<E, F>(state, backend, cells, first, distance, what);
        });
      };
      for (auto const& [words, first, distance] : {std::tuple{"two", Index{2}, Index{1}},
                                                   {"each hundredth", count, Index{100}},
                                                   {"a tenth", count / 10, Index{1}}}) {
        add_one(std::string("raise ") + words, first, distance, OfDegrees::raise);
        add_one(std::string("lower ") + words, first, distance, OfDegrees::lower);
      }
      add_one("refine two beside a tenth that is raised", count / 10, 1, OfDegrees::refine);
      add_one("coarsen two beside a tenth that is raised", count / 10, 1, OfDegrees::coarsen);
      add_one("forces where a tenth is raised", count / 10, 1, OfDegrees::forces);
    };
    one(Tet4{}, Tet10{}, 2e4);
    one(Hex8{}, Hex27{}, 2e4);
    one(Tet4{}, Tet10{}, 1e6);
  });
}

}  // namespace pliant::bench

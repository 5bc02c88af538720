#pragma once

#include <pliant/mesh/joined.hpp>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Many small bodies in one mesh beside a large one of as many elements: forces, steps, steps with looks, and steps while
// nine bodies of ten sleep.
namespace pliant::bench {

using Small = Usual<Tet4, SaintVenantKirchhoff>;
using Cheap = Usual<Tet4, Hooke>;

/// Boxes of some thousand elements, one grid cell apart from each other in a cube; `elements` in all.
inline mesh::Joined<Tet4> many_boxes(double elements) {
  auto const one = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {6, 6, 5}});
  auto const count =
      static_cast<int>(std::lround(elements / static_cast<double>(one.elements<Tet4>().size())));
  auto const edge = static_cast<int>(std::ceil(std::cbrt(count)));
  std::vector<Mesh<Tet4>> parts;
  for (int p = 0; p < count; ++p)
    parts.push_back(
        mesh::moved(one, {1.2 * (p % edge), 1.2 * (p / edge % edge), 1.2 * (p / (edge * edge))}));
  return mesh::joined(parts);
}

/// Shaken; of many, a tenth of them if others shall rest.
template <class B>
auto shaken_bodies(B const& backend, int cells, bool many, bool some_rest) {
  double const elements = static_cast<double>(element_count<Tet4>(cells));
  auto const all = many ? many_boxes(elements) : mesh::joined(std::vector{mesh_of<Tet4>(cells)});
  auto u = shaken(all.mesh.nodes, 1, 0.1);
  for (std::size_t p = 0; some_rest && p < all.parts(); ++p)
    if (p >= all.parts() / 10)
      std::fill(u.begin() + all.first_node[p], u.begin() + all.first_node[p + 1], Point<3>{});
  Body body{backend, all.mesh, soft, Group<Small>{}, Group<Cheap>{}};
  body.set_displacements(u);
  return body;
}

template <class B>
void time_many(benchmark::State& state, B const& backend, int cells, bool many,
               std::string const& what) {
  bool const sleeps = what == "sleep";
  auto& [body, step] = made_once([&] {
    auto b = shaken_bodies(backend, cells, many, sleeps);
    CentralDifference s{{.step = 0.3 * stable_step(b),
                         .check_interval = 1 << 30,
                         .refresh_interval = 1 << 30,
                         .watch_interval = 1 << 30}};
    return std::pair{std::move(b), s};
  });
  constexpr int steps = 64;
  Adaptation looks{when<Small>(StrainNorm{}).above(1e30).template become<Cheap>()};
  Adaptation rests{sleep({.below = 1e-3, .for_steps = 16})};
  auto const run = [&, &b = body, &s = step] {
    if (what == "looks")
      s(b, steps, looks);
    else if (sleeps)
      s(b, steps, rests);
    else
      s(b, steps);
  };
  run();
  measure_calls(state, backend, run);
  report_elements(state, body, steps);
  if (sleeps) {
    auto const found = asleep(body);
    state.counters["awake"] =
        1 - static_cast<double>(found.patches) / std::max(found.of_patches, 1);
  }
}

inline void add_many_bodies() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role == Role::scalar) return;
    int const cells = usual_cells<Tet4, B>();
    for (char const* const what : {"steps", "looks", "sleep"})
      for (bool const many : {false, true}) {
        if (std::string_view(what) == "sleep" && !many)
          continue;  // a body that is shaken everywhere does not
        add<Small, T>(std::string(what) + (many ? " of many bodies" : " of one body"), name, cells,
                      [backend, cells, many, what](benchmark::State& state) {
                        time_many(state, backend, cells, many, what);
                      });
      }
  });
}

}  // namespace pliant::bench

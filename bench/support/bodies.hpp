#pragma once

#include "support/formulations.hpp"
#include "support/report.hpp"

namespace pliant::bench {

/// A body that is held on its left, and shaken; `size` scales the displacements.
template <class... Fs, class B>
auto shaken_body(B const& backend, int cells, double size = 1) {
  using E = typename std::tuple_element_t<0, std::tuple<Fs...>>::element;
  auto const mesh = mesh_of<E>(cells);
  Body body{backend, mesh, soft, Group<Fs>{}...};
  body.clamp(mesh.boundary("left"));
  body.set_displacements(shaken(mesh.nodes, 1, size));
  return body;
}

/// The rate of a body's elements, each of which the work goes over so often.
template <class TheBody>
void report_elements(benchmark::State& state, TheBody& body, int times = 1) {
  double elements = 0;
  body.parts().for_each_type([&](auto const& table, auto const&) { elements += table.count(); });
  state.counters["elements"] = elements;
  report_rate(state, "items_per_second", times * elements);
}

}  // namespace pliant::bench

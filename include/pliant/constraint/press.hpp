#pragma once

#include <pliant/body/change_on_backend.hpp>
#include <pliant/constraint/conditions.hpp>
#include <pliant/force/pressure.hpp>

// What a body's pressures make of its facets, in the backend's memory.
namespace pliant {

/// Makes the force terms of state.prescribed's pressures.
template <class Parts>
void upload_pressures(Parts& parts) {
  parts.pressures.clear();
  if constexpr (detail::changes_on_backend<Parts>) {
    auto const& on = parts.topology_on;
    if (on && on->prescribed.is(parts.state.prescribed)) return on->acting.press(parts, *on);
  }
  for (auto const& pressure : parts.state.prescribed->pressures) {
    if (pressure.pascals == 0) continue;
    auto internal = pressure.facets;
    for (auto& facet : internal)
      for (Index& node : facet) node = parts.layout.internal_of(node);
    add_pressure_terms<typename Parts::mesh_type>(parts.backend, internal, pressure.pascals,
                                                  parts.layout.rows, parts.pressures);
  }
}

namespace detail {
/// What tells a list of facets from others, in whatever order they and their nodes come.
template <int Dim>
std::vector<std::array<Index, 4>> sorted_keys(std::vector<Facet<Dim>> const& facets) {
  std::vector<std::array<Index, 4>> keys;
  for (auto const& facet : facets) keys.push_back(mesh::key_of(facet));
  std::sort(keys.begin(), keys.end());
  return keys;
}
}  // namespace detail

/// Adds a pressure, or gives one that acts on the same facets another value; see Body::press.
template <class Parts>
Handle press(Parts& parts, std::vector<Facet<Parts::dim>> const& facets, double pascals) {
  using Scalar = typename Parts::T;
  if (facets.empty())
    throw Error("body.press: there is no facet; give the facets of the boundary to press");
  if (!std::isfinite(static_cast<Scalar>(pascals)))
    throw Error("body.press: the pressure of ", pascals, " Pa is not finite",
                std::isfinite(pascals) ? " in single precision" : "");
  for (auto const& facet : facets)
    for (Index node : facet)
      if (node < 0 || node >= parts.layout.nodes())
        throw Error("body.press: a facet names node ", node, ", but nodes are numbered 0 to ",
                    parts.layout.nodes() - 1);
  auto prescribed = *parts.state.prescribed;
  auto const keys = detail::sorted_keys(facets);
  auto same = std::ranges::find_if(prescribed.pressures, [&](auto const& pressure) {
    return pressure.facets.size() == keys.size() && detail::sorted_keys(pressure.facets) == keys;
  });
  if (same == prescribed.pressures.end()) {
    auto own = detail::outer_facets(parts.state.topology->mesh(), facets);
    prescribed.pressures.push_back({{prescribed.next_id++}, std::move(own), 0});
    same = prescribed.pressures.end() - 1;
  }
  same->pascals = pascals;
  Handle const handle = same->handle;
  change_by_hand(parts, [&] {
    detail::prescribe(parts, std::move(prescribed));
    parts.upload_pressures = [](Parts& p) { upload_pressures(p); };
    parts.upload_pressures(parts);
    make_room_for_forces(parts);
  });
  return handle;
}

}  // namespace pliant

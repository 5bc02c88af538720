#pragma once

#include <map>

#include <pliant/body/body.hpp>

// Members of Body: pressures that follow the surface.
namespace pliant {

namespace detail {
/// Facets told by their corners as the mesh has them: with all nodes, seen from outside.
template <class M>
std::vector<Facet<M::dim>> outer_facets(M const& mesh, std::vector<Facet<M::dim>> facets) {
  std::map<std::array<Index, 4>, Facet<M::dim>> outer;
  for (auto const& side : mesh::outer_sides(mesh)) outer.emplace(mesh::key_of(side), side);
  for (auto& facet : facets) {
    auto const refuse = [&](char const* why) {
      std::string nodes;
      for (std::size_t a = 0; a < facet.size(); ++a)
        nodes += detail::message({a == 0 ? "" : a + 1 == facet.size() ? " and " : ", ", facet[a]});
      throw Error("body.press: the facet with the nodes ", nodes, why);
    };
    auto const found = outer.find(mesh::key_of(facet));
    if (facet.size() < facet.corners() || found == outer.end())
      refuse(" is not on the boundary of the mesh; give facets of its boundary");
    if (found->second.size() == 0) refuse(" is there twice; give each facet once");
    facet = std::exchange(found->second, {});
  }
  return facets;
}
}  // namespace detail

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::press(std::vector<Facet<dim>> const& facets, double pascals) {
  if (!std::isfinite(pascals)) throw Error("body.press: the pressure is not finite");
  for (auto const& facet : facets)
    for (Index node : facet)
      if (node < 0 || node >= nodes())
        throw Error("body.press: a facet names node ", node, ", but nodes are numbered 0 to ",
                    nodes() - 1);
  auto const pressed = [&](std::vector<Facet<dim>> const& as) {
    return std::ranges::find(pressures_, as, &Pressure<dim>::facets);
  };
  auto same = pressed(facets);
  std::vector<Facet<dim>> own;
  if (same == pressures_.end()) {
    own = detail::outer_facets(layout_.mesh, facets);
    same = pressed(own);
  }
  if (same == pressures_.end() && history_.tree)
    throw Error(
        "body.press: these facets are pressed for the first time after a refinement, and would not "
        "be inherited; press facets before the first refinement, with 0 Pa if need be; after a "
        "refinement the pressed facets are body.pressures()[k].facets");
  synchronize_velocities();
  if (same == pressures_.end())
    pressures_.push_back({std::move(own), pascals});
  else
    same->pascals = pascals;
  press_again_ = [](Body& body) { body.upload_pressures(); };
  press_again_(*this);
  checkpoint_.reset();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::upload_pressures() {
  surface_forces_ = {};
  for (auto const& pressure : pressures_) {
    if (pressure.pascals == 0) continue;
    auto internal = pressure.facets;
    for (auto& facet : internal)
      for (Index& node : facet) node = layout_.internal_of(node);
    surface_forces_.press(backend_, internal, pressure.pascals, nodes());
  }
  std::size_t const rows = static_cast<std::size_t>(nodes() + surface_forces_.scratch_nodes());
  forces_current_ = false;
  if (layout_.f.size() < node_stride * rows)
    layout_.f = typename B::template Array<T>(node_stride * rows);
  else
    clear(Field{layout_.f.data()}, nodes());
  scratch_.reset();
  ++revision_;
}

}  // namespace pliant

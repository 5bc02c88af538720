#pragma once

#include <pliant/body/body.hpp>

// Members of Body: pressures that follow the surface.
namespace pliant {

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::press(std::vector<Facet<dim>> const& facets, double pascals) {
  if (!std::isfinite(pascals)) throw Error("body.press: the pressure is not finite");
  for (auto const& facet : facets)
    for (Index node : facet)
      if (node < 0 || node >= nodes())
        throw Error("body.press: a facet names node " + std::to_string(node) +
                    ", but nodes are numbered 0 to " + std::to_string(nodes() - 1));
  auto const same = std::ranges::find(pressures_, facets, &Pressure<dim>::facets);
  if (same == pressures_.end() && history_.tree)
    throw Error(
        "body.press: these facets are pressed for the first time after a refinement, and would not "
        "be inherited; press facets before the first refinement, with 0 Pa if need be");
  synchronize_velocities();
  if (same == pressures_.end())
    pressures_.push_back({facets, pascals});
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

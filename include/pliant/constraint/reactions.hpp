#pragma once

#include <pliant/constraint/conditions.hpp>

namespace pliant {

/// The forces that a condition exerts on its nodes in its directions, N: what balances internal forces, loads
/// and gravity there; a node that several conditions hold has it in each. The inertia of driven nodes
/// (their lumped mass times the motion's acceleration) is not in them.
template <class Parts>
std::vector<Point<Parts::dim>> reactions(Parts& parts, Handle handle) {
  auto const& conditions = parts.state.prescribed->conditions;
  auto const found = std::ranges::find(conditions, handle, &Condition<Parts::dim>::handle);
  if (found == conditions.end())
    throw Error("body.reactions: handle ", handle.id, " names no condition of this body");
  evaluate_all_forces(parts);
  parts.layout.interpolation.clear(parts.backend, parts.f());  // the masters have it
  auto const external = external_forces(parts);
  auto const f = parts.layout.in_user_order(parts.layout.f);
  std::vector<Point<Parts::dim>> load;
  if (external.load != nullptr)
    load = parts.layout.in_user_order(parts.layout.load.size() > 0 ? parts.layout.load
                                                                   : parts.state.load);
  std::vector<Point<Parts::dim>> forces;
  for (Index node : found->nodes) {
    auto const i = static_cast<std::size_t>(node);
    Point<Parts::dim> force{};
    for (std::size_t k = 0; k < Parts::dim; ++k)
      if (found->directions >> k & 1)
        force[k] = -(f[i][k] + parts.layout.mass_list()[i] * parts.state.gravity[k] +
                     (load.empty() ? 0.0 : load[i][k]));
    forces.push_back(force);
  }
  return forces;
}

}  // namespace pliant

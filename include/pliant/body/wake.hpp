#pragma once

#include <pliant/body/parts.hpp>

// Waking, for what changes bodies: nothing is compiled for those that nothing looks for rest in.
namespace pliant {

/// Brings parts.awake up to state.rest. Forces are to be evaluated anew. A state that another backend saved, with
/// other patches, has nothing that sleeps.
template <class Parts>
void follow_rest(Parts& parts) {
  if (parts.sleep != nullptr) parts.sleep->follow_rest(parts);
}
/// Wakes all patches.
template <class Parts>
void wake_all(Parts& parts) {
  if (parts.sleep != nullptr) parts.sleep->wake_all(parts);
}
/// Wakes the patches around some nodes, given by internal numbers.
template <class Parts>
void wake_nodes(Parts& parts, std::span<Index const> nodes) {
  if (parts.sleep != nullptr) parts.sleep->wake_nodes(parts, nodes);
}

}  // namespace pliant

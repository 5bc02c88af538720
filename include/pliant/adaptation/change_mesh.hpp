#pragma once

#include <cstddef>
#include <vector>

#include <pliant/adaptation/change_on_backend.hpp>
#include <pliant/adaptation/commit.hpp>

namespace pliant::detail {

/// What a change of a body's mesh did.
template <class M>
struct MeshChanged {
  typename TopologyPlan<M>::Counts counts{};
  std::size_t new_nodes = 0, gone_nodes = 0;
};

template <Backend B>
MarkedElements on_host(B const& backend, MarkedLists<ElementsThere> const& marked) {
  return MarkedThere<B>::of(marked).lists(backend);
}
template <Backend B>
MarkedElements on_host(B const&, MarkedLists<> const& marked) {
  auto const copy = [](auto const& lists) {
    return std::vector<std::vector<Index>>(lists.begin(), lists.end());
  };
  return {copy(marked.refine), copy(marked.coarsen),      copy(marked.raise), copy(marked.lower),
          copy(marked.split),  copy(marked.split_in_two), copy(marked.merge), marked.raised_rings};
}

/// Changes the mesh of a body, in its backend's memory or on the host, and tells listeners, who may throw. Errors as of refine.
template <class TheBody, class List>
auto change_mesh(TheBody& body, MarkedLists<List> const& marked, int max_level = most_levels)
    -> MeshChanged<typename TheBody::mesh_type> {
  static_assert(can_be_refined<typename TheBody::mesh_type>,
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  auto& parts = body.parts();
  if (auto const done = change_on_backend(parts, marked, max_level)) {
    tell_listeners(parts, done->to_tell);
    return {done->counts, done->new_nodes, done->gone_nodes};
  }
  auto const plan = plan_change(parts, on_host(parts.backend, marked), max_level);
  if (!plan) return {};
  commit(parts, *plan);
  tell_listeners(parts, *plan);
  return {plan->counts, plan->transfer.new_nodes().size(), plan->transfer.gone().size()};
}

}  // namespace pliant::detail

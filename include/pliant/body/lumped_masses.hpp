#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <pliant/body/touched_elements.hpp>
#include <pliant/formulation/affine.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant::detail {

/// Calls add(node, share) for the share that each element's nodes have of its mass, kg, on the threads of the host: each node is
/// one thread's, and its shares come in the order of elements, as in a loop over these, so that sums have the same bits.
template <Element E, class M, class Add>
void add_in_order(M const& mesh, double density, Add const& add) {
  auto const& elements = mesh.template elements<E>();
  std::size_t const places = elements.size() * E::nodes;
  auto const node = [&](std::size_t place) { return elements[place / E::nodes][place % E::nodes]; };
  auto const shares = std::make_unique_for_overwrite<double[]>(places);
  for_each_on_host(static_cast<Index>(elements.size()), few_elements(E::nodes), [&](Index i) {
    auto const e = static_cast<std::size_t>(i);
    auto const share = host_nodal_masses<E>(nodal(mesh, elements[e]), density);
    for (std::size_t a = 0; a < E::nodes; ++a)
      shares[e * E::nodes + a] = share[static_cast<int>(a)];
  });
  auto const order = std::make_unique_for_overwrite<Index[]>(places);
  auto const count = static_cast<Index>(mesh.nodes.size());
  Index const shift = shift_to_few(count), ranges = (count >> shift) + 1;
  auto const range_of = [&](Index place) { return node(static_cast<std::size_t>(place)) >> shift; };
  auto const begin = distribute(
      static_cast<Index>(places), ranges,
      [&](Index from, Index to, Index* numbers) {
        for (Index place = from; place < to; ++place) ++numbers[range_of(place)];
      },
      [&](Index from, Index to, Index* next) {
        for (Index place = from; place < to; ++place)
          order[static_cast<std::size_t>(next[range_of(place)]++)] = place;
      });
  for_each_on_host(ranges, 1, [&](Index range) {
    auto const r = static_cast<std::size_t>(range);
    for (Index k = begin[r]; k < begin[r + 1]; ++k) {
      auto const place = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
      add(static_cast<std::size_t>(node(place)), shares[place]);
    }
  });
}

/// Adds the lumped masses of a type's elements to their nodes', kg.
template <Element E, class M>
void add_masses(M const& mesh, double density, std::vector<double>& masses) {
  auto const& elements = mesh.template elements<E>();
  auto const add = [&](std::size_t node, double share) { masses[node] += share; };
  HostParts const parts(static_cast<Index>(elements.size()), few_elements(E::nodes));
  if (parts.count() > 1 && has_many_host_threads() &&
      elements.size() <= std::numeric_limits<Index>::max() / E::nodes)
    return add_in_order<E>(mesh, density, add);
  for (auto const& element : elements) {
    auto const share = host_nodal_masses<E>(nodal(mesh, element), density);
    for (std::size_t a = 0; a < E::nodes; ++a)
      add(static_cast<std::size_t>(element[a]), share[static_cast<int>(a)]);
  }
}

/// The lumped masses of a mesh's nodes, kg, slaves' with them.
template <Element... Es>
std::vector<double> lumped_masses(Mesh<Es...> const& mesh, double density) {
  std::vector<double> masses(mesh.nodes.size(), 0.0);
  (add_masses<Es>(mesh, density, masses), ...);
  return masses;
}
/// The same by those `before` a change of the topology: summed anew where nodes have elements that came or went, in the same
/// order.
template <class M>
SharedList<double> changed_masses(Topology<M> const& topology, double density,
                                  SharedList<double> const& before,
                                  Transfer<M::dim> const& transfer,
                                  TouchedElements<M> const& touched) {
  auto masses = before;
  if (transfer.staying_nodes() < transfer.old_nodes())
    masses.keep(0, [&](std::size_t i) { return transfer.renumbered(static_cast<Index>(i)) >= 0; });
  for (Index node = transfer.staying_nodes(); node < transfer.nodes(); ++node) masses.push_back(0);
  for (Index const node : touched.nodes())
    if (touched.changes_elements(node)) masses.edit(static_cast<std::size_t>(node)) = 0;
  for_each_type_of<M>([&]<Element E>(E, std::size_t) {
    for (auto const& element : touched.template nodes_after<E>()) {
      auto const share = host_nodal_masses<E>(nodal(topology, element), density);
      for (std::size_t a = 0; a < E::nodes; ++a)
        if (touched.changes_elements(element[a]))
          masses.edit(static_cast<std::size_t>(element[a])) += share[static_cast<int>(a)];
    }
  });
  return masses;
}

}  // namespace pliant::detail

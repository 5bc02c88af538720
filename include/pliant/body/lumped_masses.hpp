#pragma once

#include <memory>
#include <vector>

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

}  // namespace pliant::detail

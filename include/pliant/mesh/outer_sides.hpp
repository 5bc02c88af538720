#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/sides.hpp>

// The boundary of a mesh.
namespace pliant::mesh {

namespace detail {

/// A number that scatters node numbers over 64 bits (the finalizer of SplitMix64, Steele et al. 2014).
inline std::uint64_t scattered(Index node) {
  auto x = static_cast<std::uint64_t>(node) + 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// Calls visit(the smallest corner, the sum of the scattered corners) for each side of an element.
template <Element E, class Visit>
inline PLIANT_INLINE void for_each_side_sum(Connectivity<E> const& element, Visit const& visit) {
  static constexpr auto sides = E::cell::sides();
  std::array<std::uint64_t, E::cell::corners> scatter;
  for (std::size_t a = 0; a < scatter.size(); ++a) scatter[a] = scattered(element[a]);
  for (std::size_t s = 0; s < sides.size(); ++s) {
    std::uint64_t sum = 0;
    Index smallest = std::numeric_limits<Index>::max();
    for (int corner : sides[s])
      if (corner >= 0) {
        sum += scatter[static_cast<std::size_t>(corner)];
        smallest = std::min(smallest, element[static_cast<std::size_t>(corner)]);
      }
    visit(s, smallest, sum);
  }
}

/// Where a side is found: the number of its element's type among the mesh's, of the element, and on its cell.
using PlaceOfSide = std::array<Index, 4>;  // and its smallest corner

template <Element... Es>
Facet<Mesh<Es...>::dim> side_at(Mesh<Es...> const& mesh, PlaceOfSide const& place) {
  Facet<Mesh<Es...>::dim> facet;
  auto const e = static_cast<std::size_t>(place[1]);
  Index type = 0;
  ((type++ == place[0] ? void(facet = side_of<Es>(mesh.template elements<Es>()[e], place[2]))
                       : void()),
   ...);
  return facet;
}

/// Flips bits[corner] by the sums of the sides of elements, first to last, with the smallest corner there.
template <Element E>
void flip_sides(std::vector<Connectivity<E>> const& elements, Index first, Index last,
                std::vector<std::uint64_t>& bits, bool is_shared) {
  auto const count = static_cast<Index>(bits.size());
  for (auto e = static_cast<std::size_t>(first); e < static_cast<std::size_t>(last); ++e) {
    auto const element = elements[e];
    for (Index node : element)
      if (node < 0 || node >= count)
        throw Error("mesh: an element refers to node ", node, ", but the mesh has ", bits.size(),
                    " nodes; correct the connectivity");
    for_each_side_sum<E>(element, [&](std::size_t, Index corner, std::uint64_t sum) {
      auto& own = bits[static_cast<std::size_t>(corner)];
      if (is_shared)
        std::atomic_ref(own).fetch_xor(sum, std::memory_order_relaxed);
      else
        own ^= sum;
    });
  }
}

/// The sides of elements but those whose smallest corner has none but sides that are there twice: they cancel in the
/// exclusive or over the sides of one smallest corner, so that most corners are done with; 64 bits make an accidental
/// zero as good as impossible. Throws Error for an element of nodes that the mesh has not.
template <Element... Es>
std::vector<PlaceOfSide> sides_that_may_be_outer(Mesh<Es...> const& mesh) {
  std::vector<std::uint64_t> left(mesh.nodes.size());
  auto const parts_of = [&]<Element E>(E) {
    return pliant::detail::HostParts(static_cast<Index>(mesh.template elements<E>().size()),
                                     pliant::detail::few_elements(E::nodes));
  };
  auto const flip = [&]<Element E>(E) {
    auto const& elements = mesh.template elements<E>();
    auto const parts = parts_of(E{});
    if (parts.count() == 1 || !pliant::detail::has_many_host_threads())
      return flip_sides<E>(elements, 0, static_cast<Index>(elements.size()), left, false);
    parts([&](Index first, Index last, int) { flip_sides<E>(elements, first, last, left, true); });
  };
  (flip(Es{}), ...);
  std::vector<PlaceOfSide> all;
  Index type = 0;
  auto const collect = [&]<Element E>(E) {
    auto const parts = parts_of(E{});
    std::vector<std::vector<PlaceOfSide>> of_parts(static_cast<std::size_t>(parts.count()));
    parts([&](Index first, Index last, int part) {
      auto& found = of_parts[static_cast<std::size_t>(part)];
      for (Index e = first; e < last; ++e) {
        auto const& element = mesh.template elements<E>()[static_cast<std::size_t>(e)];
        std::uint64_t any = 0;  // of all nodes, without a branch for each
        for (Index node : element) any |= left[static_cast<std::size_t>(node)];
        if (any == 0) continue;
        for_each_side_sum<E>(element, [&](std::size_t s, Index corner, std::uint64_t) {
          if (left[static_cast<std::size_t>(corner)] != 0)
            found.push_back({type, e, static_cast<Index>(s), corner});
        });
      }
    });
    for (auto const& found : of_parts) all.insert(all.end(), found.begin(), found.end());
    ++type;
  };
  (collect(Es{}), ...);
  return all;
}

}  // namespace detail

/// The sides of elements that have no element behind them: the boundary of a mesh, in the order of their
/// smallest corner. Throws Error for an element of nodes that the mesh has not.
template <Element... Es>
std::vector<Facet<Mesh<Es...>::dim>> outer_sides(Mesh<Es...> const& mesh) {
  HostThreads const threads(mesh);
  auto const found = detail::sides_that_may_be_outer(mesh);
  std::vector<Index> smallest;
  std::vector<std::array<Index, 4>> keys;
  smallest.reserve(found.size());
  keys.reserve(found.size());
  for (auto const& place : found) {
    smallest.push_back(place[3]);
    keys.push_back(key_of(detail::side_at(mesh, place)));
  }
  // Two elements that share a side see the same corners: look for them among those of one corner.
  auto const at_corner =
      pliant::detail::group_by_key(smallest, static_cast<Index>(mesh.nodes.size()));
  std::vector<Facet<Mesh<Es...>::dim>> outer;
  auto const is_same = [](auto const& a, auto const& b) {  // without a call of memcmp
    return a[3] == b[3] && a[2] == b[2] && a[1] == b[1] && a[0] == b[0];
  };
  for (std::size_t corner = 0; corner < mesh.nodes.size(); ++corner)
    for (Index i = at_corner.first[corner]; i < at_corner.first[corner + 1]; ++i) {
      auto const side = [&](Index k) {
        return static_cast<std::size_t>(at_corner.order[static_cast<std::size_t>(k)]);
      };
      int times = 0;
      for (Index k = at_corner.first[corner]; k < at_corner.first[corner + 1]; ++k)
        times += is_same(keys[side(k)], keys[side(i)]);
      if (times == 1) outer.push_back(detail::side_at(mesh, found[side(i)]));
    }
  return outer;
}

/// The outer sides all of whose nodes satisfy a condition on their place: belongs(Point) -> bool.
template <Element... Es, class Belongs>
std::vector<Facet<Mesh<Es...>::dim>> outer_sides_where(Mesh<Es...> const& mesh,
                                                       Belongs const& belongs) {
  auto facets = outer_sides(mesh);
  std::erase_if(facets, [&](auto const& facet) {
    return !std::ranges::all_of(
        facet, [&](Index node) { return belongs(mesh.nodes[static_cast<std::size_t>(node)]); });
  });
  return facets;
}

}  // namespace pliant::mesh

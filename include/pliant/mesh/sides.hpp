#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <utility>

#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/mesh.hpp>

// From elements to the boundary, and from corners to the nodes between them.
namespace pliant::mesh {

/// The nodes of an element type on one side of its cell, in the order of a facet: corners, middles of its
/// edges beginning behind corner 0, its own middle.
template <Element E>
constexpr auto nodes_on_side(int side) {
  constexpr auto sides = E::cell::sides();
  Facet<E::dim> local;
  auto const& corners = sides[static_cast<std::size_t>(side)];
  for (int corner : corners)
    if (corner >= 0) local.push_back(corner);
  std::size_t const count = local.size();
  auto const take = [&](Vector<double, E::dim> const& place) {
    for (int a = E::cell::corners; a < E::nodes; ++a) {
      auto const apart = E::place(a) - place;
      if (dot(apart, apart) < 1e-9) local.push_back(a);
    }
  };
  auto middle = Vector<double, E::dim>::zero();
  for (std::size_t c = 0; c < count; ++c) {
    auto const here = E::cell::corner(local[c]), next = E::cell::corner(local[(c + 1) % count]);
    middle = middle + 1.0 / static_cast<double>(count) * here;
    if (E::dim == 3) take(0.5 * (here + next));
  }
  take(middle);
  return local;
}

/// The side of an element as a facet.
template <Element E>
Facet<E::dim> side_of(Connectivity<E> const& element, int side) {
  static constexpr auto local = [] {
    std::array<Facet<E::dim>, E::cell::sides().size()> all;
    for (std::size_t s = 0; s < all.size(); ++s) all[s] = nodes_on_side<E>(static_cast<int>(s));
    return all;
  }();
  Facet<E::dim> facet = local[static_cast<std::size_t>(side)];
  for (Index& node : facet) node = element[static_cast<std::size_t>(node)];
  return facet;
}

/// The corners of a facet in ascending order: the same for both elements beside it.
template <int Dim>
std::array<Index, 4> key_of(Facet<Dim> const& facet) {
  auto const n = facet.corners();
  std::array<Index, 4> key{facet[0], facet[1], n > 2 ? facet[2] : -1, n > 3 ? facet[3] : -1};
  auto const order = [&](std::size_t a, std::size_t b) {
    auto const [low, high] = std::pair(std::min(key[a], key[b]), std::max(key[a], key[b]));
    key[a] = low, key[b] = high;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);  // a sorting network
  return key;
}

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

}  // namespace detail

namespace detail {

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

/// Calls visit(k, side) for each side of an element that has the corners of keys[k], see key_of, in the order of elements.
/// Keys ascend.
template <Element... Es, class Visit>
void for_each_side_with(Mesh<Es...> const& mesh, std::vector<std::array<Index, 4>> const& keys,
                        Visit const& visit) {
  constexpr int Dim = Mesh<Es...>::dim;
  std::vector<std::uint8_t> named(mesh.nodes.size(), 0);
  for (auto const& key : keys)
    for (Index node : key)
      if (node >= 0 && node < static_cast<Index>(named.size()))
        named[static_cast<std::size_t>(node)] = 1;
  auto const look_at = [&]<Element E>(E) {
    auto const& elements = mesh.template elements<E>();
    pliant::detail::HostParts const parts(static_cast<Index>(elements.size()),
                                          pliant::detail::few_elements(E::nodes));
    // Per part: the place among the keys, the element, and its side.
    std::vector<std::vector<std::array<Index, 4>>> found(static_cast<std::size_t>(parts.count()));
    parts([&](Index first, Index last, int part) {
      for (auto e = static_cast<std::size_t>(first); e < static_cast<std::size_t>(last); ++e) {
        int corners = 0;
        for (std::size_t a = 0; a < E::cell::corners; ++a)
          corners += named[static_cast<std::size_t>(elements[e][a])];
        if (corners < Dim) continue;
        for (std::size_t s = 0; s < E::cell::sides().size(); ++s) {
          auto const own = key_of(side_of<E>(elements[e], static_cast<int>(s)));
          auto const key = std::lower_bound(keys.begin(), keys.end(), own);
          if (key != keys.end() && *key == own)
            found[static_cast<std::size_t>(part)].push_back({static_cast<Index>(key - keys.begin()),
                                                             static_cast<Index>(e),
                                                             static_cast<Index>(s)});
        }
      }
    });
    for (auto const& of_part : found)
      for (auto const& [k, e, s, none] : of_part)
        visit(static_cast<std::size_t>(k), side_of<E>(elements[static_cast<std::size_t>(e)], s));
  };
  (look_at(Es{}), ...);
}

/// Facets, ascending by key_of, each of which stands for those with the same corners.
template <int Dim>
class FacetsByCorners {
 public:
  void add(Facet<Dim> const& facet) { keys_.push_back(key_of(facet)); }
  /// Behind the last one that is added.
  void sort() {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    facets_.resize(keys_.size());
  }
  std::vector<std::array<Index, 4>> const& keys() const { return keys_; }
  Facet<Dim>& operator[](std::size_t k) { return facets_[k]; }
  /// For one that was added: empty, or what was assigned.
  Facet<Dim> const& at(Facet<Dim> const& facet) const {
    return facets_[static_cast<std::size_t>(
        std::lower_bound(keys_.begin(), keys_.end(), key_of(facet)) - keys_.begin())];
  }

 private:
  std::vector<std::array<Index, 4>> keys_;
  std::vector<Facet<Dim>> facets_;
};

/// Facets told by their corners as the mesh has them: with all nodes of a side of an element, outer sides as they
/// are seen from outside. Throws Error for a facet that is no side of an element.
template <Element... Es>
std::vector<Facet<Mesh<Es...>::dim>> sides_of(Mesh<Es...> const& mesh,
                                              std::vector<Facet<Mesh<Es...>::dim>> facets) {
  constexpr int Dim = Mesh<Es...>::dim;
  HostThreads const threads(mesh);
  FacetsByCorners<Dim> found;
  auto const refuse = [](Facet<Dim> const& facet, char const* why) {
    std::string nodes;
    for (Index node : facet) nodes += pliant::detail::message({" ", node});
    throw Error("mesh: the facet with the nodes", nodes, why);
  };
  for (auto const& facet : facets) {
    for (Index node : facet)
      if (node < 0 || node >= static_cast<Index>(mesh.nodes.size()))
        throw Error("mesh: a facet names node ", node, ", but nodes are numbered 0 to ",
                    mesh.nodes.size() - 1);
    if (facet.size() < facet.corners()) refuse(facet, " has too few of them; give its corners");
    found.add(facet);
  }
  found.sort();
  for_each_side_with(mesh, found.keys(), [&](std::size_t k, Facet<Dim> const& side) {
    if (found[k].size() < side.size()) found[k] = side;
  });
  for (auto& facet : facets) {
    auto const& side = found.at(facet);
    if (side.size() == 0)
      refuse(facet,
             " is no side of an element; give facets of the present mesh, which after a refinement "
             "is another");
    facet = side;
  }
  return facets;
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

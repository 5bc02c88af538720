#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/mesh/mesh.hpp>

// The sides of elements, told by their corners.
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

}  // namespace pliant::mesh

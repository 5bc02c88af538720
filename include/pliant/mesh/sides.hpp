#pragma once

#include <cstdint>
#include <limits>
#include <map>

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
  std::array<Index, 4> key{-1, -1, -1, -1};
  std::copy_n(facet.begin(), facet.corners(), key.begin());
  std::sort(key.data(), key.data() + key.size());
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
void for_each_side_sum(Connectivity<E> const& element, Visit const& visit) {
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

/// The sides of elements that have no element behind them: the boundary of a mesh, in the order of their
/// smallest corner. Throws Error for an element of nodes that the mesh has not.
template <Element... Es>
std::vector<Facet<Mesh<Es...>::dim>> outer_sides(Mesh<Es...> const& mesh) {
  auto const count = static_cast<Index>(mesh.nodes.size());
  // Sides that are there twice cancel in the exclusive or over the sides of one smallest corner, so that most
  // corners are done with; 64 bits make an accidental zero as good as impossible.
  std::vector<std::uint64_t> left(mesh.nodes.size(), 0);
  auto const add = [&]<Element E>(E) {
    for (auto const& element : mesh.template elements<E>()) {
      for (Index node : element)
        if (node < 0 || node >= count)
          throw Error("mesh: an element refers to node ", node, ", but the mesh has ",
                      mesh.nodes.size(), " nodes; correct the connectivity");
      detail::for_each_side_sum<E>(element, [&](std::size_t, Index corner, std::uint64_t sum) {
        left[static_cast<std::size_t>(corner)] ^= sum;
      });
    }
  };
  (add(Es{}), ...);
  std::vector<Facet<Mesh<Es...>::dim>> sides, outer;
  std::vector<std::array<Index, 4>> keys;
  std::vector<Index> smallest;
  auto const collect = [&]<Element E>(E) {
    for (auto const& element : mesh.template elements<E>()) {
      std::uint64_t any = 0;  // of all nodes, without a branch for each
      for (Index node : element) any |= left[static_cast<std::size_t>(node)];
      if (any == 0) continue;
      detail::for_each_side_sum<E>(element, [&](std::size_t s, Index corner, std::uint64_t) {
        if (left[static_cast<std::size_t>(corner)] == 0) return;
        sides.push_back(side_of<E>(element, static_cast<int>(s)));
        keys.push_back(key_of(sides.back()));
        smallest.push_back(corner);
      });
    }
  };
  (collect(Es{}), ...);
  // Two elements that share a side see the same corners: look for them among those of one corner.
  auto const at_corner = pliant::detail::group_by_key(smallest, count);
  for (std::size_t corner = 0; corner < mesh.nodes.size(); ++corner)
    for (Index i = at_corner.first[corner]; i < at_corner.first[corner + 1]; ++i) {
      auto const side = [&](Index k) {
        return static_cast<std::size_t>(at_corner.order[static_cast<std::size_t>(k)]);
      };
      int times = 0;
      for (Index k = at_corner.first[corner]; k < at_corner.first[corner + 1]; ++k)
        times += keys[side(k)] == keys[side(i)];
      if (times == 1) outer.push_back(sides[side(i)]);
    }
  return outer;
}

/// Facets told by their corners as the mesh has them: with all nodes of a side of an element, outer sides as they
/// are seen from outside. Throws Error for a facet that is no side of an element.
template <Element... Es>
std::vector<Facet<Mesh<Es...>::dim>> sides_of(Mesh<Es...> const& mesh,
                                              std::vector<Facet<Mesh<Es...>::dim>> facets) {
  constexpr int Dim = Mesh<Es...>::dim;
  std::map<std::array<Index, 4>, Facet<Dim>> found;
  std::vector<bool> named(mesh.nodes.size(), false);
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
    found.emplace(key_of(facet), Facet<Dim>{});
    for (Index node : facet) named[static_cast<std::size_t>(node)] = true;
  }
  auto const look_at = [&]<Element E>(E) {
    for (auto const& element : mesh.template elements<E>()) {
      int corners = 0;
      for (int a = 0; a < E::cell::corners; ++a)
        corners += named[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])];
      if (corners < Dim) continue;
      for (std::size_t s = 0; s < E::cell::sides().size(); ++s) {
        auto const side = side_of<E>(element, static_cast<int>(s));
        auto const entry = found.find(key_of(side));
        if (entry != found.end() && entry->second.size() < side.size()) entry->second = side;
      }
    }
  };
  (look_at(Es{}), ...);
  for (auto& facet : facets) {
    auto const& side = found.at(key_of(facet));
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

/// The same cells with elements of a higher degree: nodes are added in the middle of edges, sides and
/// cells, on straight lines. Facets of the boundaries gain their nodes. (Move nodes afterwards for
/// curved cells.)
template <Element E, Element Linear>
  requires std::same_as<typename E::cell, typename Linear::cell> && (Linear::degree == 1)
Mesh<E> raised(Mesh<Linear> const& from) {
  constexpr int corners = E::cell::corners;
  Mesh<E> to;
  to.nodes = from.nodes;
  std::map<std::array<Index, corners>, Index> between;  // by the corners around the new node
  for (auto const& element : from.template elements<Linear>()) {
    Connectivity<E> raised;
    std::copy_n(element.begin(), corners, raised.begin());
    for (int a = corners; a < E::nodes; ++a) {
      auto const share = E::cell::linear(E::place(a));
      std::array<Index, corners> around;
      around.fill(-1);
      Point<E::dim> middle{};
      for (int b = 0; b < corners; ++b) {
        if (!(share[b] > 1e-9)) continue;
        Index const node = element[static_cast<std::size_t>(b)];
        around[static_cast<std::size_t>(b)] = node;
        for (std::size_t k = 0; k < E::dim; ++k)
          middle[k] += share[b] * from.nodes[static_cast<std::size_t>(node)][k];
      }
      std::ranges::sort(around);
      auto const [entry, is_new] = between.try_emplace(around, static_cast<Index>(to.nodes.size()));
      if (is_new) to.nodes.push_back(middle);
      raised[static_cast<std::size_t>(a)] = entry->second;
    }
    to.template elements<E>().push_back(raised);
  }
  if (from.boundaries.empty()) return to;
  std::map<std::array<Index, 4>, Facet<E::dim>> facets;
  for (auto const& element : to.template elements<E>())
    for (std::size_t s = 0; s < E::cell::sides().size(); ++s) {
      auto const facet = side_of<E>(element, static_cast<int>(s));
      facets[key_of(facet)] = facet;
    }
  for (auto const& [name, list] : from.boundaries)
    for (auto const& facet : list) {
      auto const found = facets.find(key_of(facet));
      if (found == facets.end())
        throw Error("mesh::raised: a facet of the boundary \"", name,
                    "\" is no side of an element; name the boundaries of the present elements");
      to.boundaries[name].push_back(found->second);
    }
  return to;
}

}  // namespace pliant::mesh

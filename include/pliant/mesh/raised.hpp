#pragma once

#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/sides.hpp>

namespace pliant::mesh {

namespace detail {

/// Which nodes an element has behind those of its corners, and between which corners they lie.
template <Element E>
struct RaisedNodes {
  static constexpr std::size_t corners = E::cell::corners, count = E::nodes - corners;
  using Corners = std::array<Index, corners>;
  struct Node {
    std::size_t size = 0;                       // how many corners are around it
    std::array<std::size_t, corners> corner{};  // these
    std::array<double, corners> share{};        // their values of its linear shape functions

    /// The corners of an element around the node, ascending, with −1 behind them.
    Corners around(Corners const& element) const {
      Corners nodes;
      nodes.fill(-1);
      for (std::size_t b = 0; b < size; ++b) {
        Index const node = element[corner[b]];
        std::size_t at = b;
        for (; at > 0 && nodes[at - 1] > node; --at) nodes[at] = nodes[at - 1];
        nodes[at] = node;
      }
      return nodes;
    }
    Index smallest(Corners const& element) const {
      Index least = element[corner[0]];
      for (std::size_t b = 1; b < size; ++b) least = std::min(least, element[corner[b]]);
      return least;
    }
    Point<E::dim> place(Corners const& element, std::vector<Point<E::dim>> const& nodes) const {
      Point<E::dim> middle{};
      for (std::size_t b = 0; b < size; ++b)
        for (std::size_t k = 0; k < E::dim; ++k)
          middle[k] += share[b] * nodes[static_cast<std::size_t>(element[corner[b]])][k];
      return middle;
    }
  };

  static std::array<Node, count> const& all() {
    static auto const nodes = [] {
      std::array<Node, count> all;
      auto const values = linear_at_nodes<E>();
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = 0; b < corners; ++b) {
          double const share = values(static_cast<int>(corners + a), static_cast<int>(b));
          if (!(share > 1e-9)) continue;
          all[a].corner[all[a].size] = b;
          all[a].share[all[a].size++] = share;
        }
      return all;
    }();
    return nodes;
  }
};

/// Numbers for the nodes that elements gain. Elements with the same corners around one share it, which is numbered
/// where the first of them has it.
template <Element E>
class AddedNumbers {
  using Added = RaisedNodes<E>;

 public:
  using Corners = typename Added::Corners;
  AddedNumbers(std::vector<Corners> const& elements, Index nodes)
      : elements_(elements), first_(elements.size() * Added::count), number_(first_.size()) {
    find_first(nodes);
    number(nodes);
  }
  /// The number of an element's added node, and whether this element is the first that has it.
  Index number(std::size_t e, std::size_t a) const {
    return number_[static_cast<std::size_t>(first_[e * Added::count + a])];
  }
  bool is_first(std::size_t e, std::size_t a) const {
    return first_[e * Added::count + a] == static_cast<Index>(e * Added::count + a);
  }
  /// Behind the largest number.
  Index end() const { return end_; }

 private:
  static constexpr Index few = pliant::detail::few_elements(E::nodes);

  /// Of each place in the table of added nodes, the first one of the same node.
  void find_first(Index nodes) {
    auto const places = static_cast<Index>(first_.size());
    std::vector<Index> smallest(first_.size());
    each_place([&](std::size_t e, std::size_t a, std::size_t place) {
      smallest[place] = Added::all()[a].smallest(elements_[e]);
    });
    auto const at_corner = pliant::detail::group_by_key(smallest, nodes);
    pliant::detail::HostParts const parts(nodes,
                                          std::max(1, 16384 / (1 + places / std::max(1, nodes))));
    parts([&](Index from, Index to, int) {
      std::vector<std::pair<Corners, Index>> seen;  // at one corner, which few share
      for (auto corner = static_cast<std::size_t>(from); corner < static_cast<std::size_t>(to);
           ++corner) {
        seen.clear();
        for (Index k = at_corner.first[corner]; k < at_corner.first[corner + 1]; ++k) {
          Index const place = at_corner.order[static_cast<std::size_t>(k)];
          auto const p = static_cast<std::size_t>(place);
          auto const around = Added::all()[p % Added::count].around(elements_[p / Added::count]);
          auto same = std::ranges::find(seen, around, &std::pair<Corners, Index>::first);
          if (same == seen.end()) same = seen.insert(same, {around, place});
          first_[p] = same->second;
        }
      }
    });
  }
  void number(Index nodes) {
    pliant::detail::HostParts const parts(static_cast<Index>(elements_.size()), few);
    std::vector<Index> begin(static_cast<std::size_t>(parts.count()));
    auto const each_first = [&](Index from, Index to, auto const& visit) {
      for (auto p = static_cast<std::size_t>(from) * Added::count;
           p < static_cast<std::size_t>(to) * Added::count; ++p)
        if (first_[p] == static_cast<Index>(p)) visit(p);
    };
    parts([&](Index from, Index to, int part) {
      Index count = 0;
      each_first(from, to, [&](std::size_t) { ++count; });
      begin[static_cast<std::size_t>(part)] = count;
    });
    end_ = nodes;
    for (Index& first : begin) end_ += std::exchange(first, end_);
    parts([&](Index from, Index to, int part) {
      Index next = begin[static_cast<std::size_t>(part)];
      each_first(from, to, [&](std::size_t p) { number_[p] = next++; });
    });
  }
  template <class Visit>
  void each_place(Visit const& visit) const {
    pliant::detail::for_each_on_host(static_cast<Index>(elements_.size()), few, [&](Index e) {
      for (std::size_t a = 0; a < Added::count; ++a)
        visit(static_cast<std::size_t>(e), a, static_cast<std::size_t>(e) * Added::count + a);
    });
  }

  std::vector<Corners> const& elements_;
  std::vector<Index> first_, number_;  // (elements, added nodes)
  Index end_ = 0;
};

template <Element E, Element Linear>
Mesh<E> with_added_nodes(Mesh<Linear> const& from) {
  using Added = RaisedNodes<E>;
  auto const& linear = from.template elements<Linear>();
  HostThreads const threads(HostThreads::worth(E::nodes * linear.size()));
  AddedNumbers<E> const numbers(linear, static_cast<Index>(from.nodes.size()));
  Mesh<E> to;
  to.nodes.reserve(static_cast<std::size_t>(numbers.end()));
  to.nodes = from.nodes;
  to.nodes.resize(static_cast<std::size_t>(numbers.end()));
  auto& elements = to.template elements<E>();
  elements.resize(linear.size());
  pliant::detail::for_each_on_host(
      static_cast<Index>(linear.size()), pliant::detail::few_elements(E::nodes), [&](Index i) {
        auto const e = static_cast<std::size_t>(i);
        std::ranges::copy(linear[e], elements[e].begin());
        for (std::size_t a = 0; a < Added::count; ++a) {
          Index const node = numbers.number(e, a);
          elements[e][Added::corners + a] = node;
          if (numbers.is_first(e, a))
            to.nodes[static_cast<std::size_t>(node)] = Added::all()[a].place(linear[e], from.nodes);
        }
      });
  FacetsByCorners<E::dim> facets;
  for (auto const& [name, list] : from.boundaries)
    for (auto const& facet : list) facets.add(facet);
  facets.sort();
  for_each_side_with(to, facets.keys(),
                     [&](std::size_t k, Facet<E::dim> const& side) { facets[k] = side; });
  for (auto const& [name, list] : from.boundaries)
    for (auto const& facet : list) {
      auto const& side = facets.at(facet);
      if (side.size() == 0)
        throw Error("mesh::raised: a facet of the boundary \"", name,
                    "\" is no side of an element; name the boundaries of the present elements");
      to.boundaries[name].push_back(side);
    }
  return to;
}

}  // namespace detail

/// The same cells with elements of a higher degree: nodes are added in the middle of edges, sides and
/// cells, on straight lines. Facets of the boundaries gain their nodes. (Move nodes afterwards for
/// curved cells.)
template <Element E, Element Linear>
  requires std::same_as<typename E::cell, typename Linear::cell> && (Linear::degree == 1)
Mesh<E> raised(Mesh<Linear> const& from) {
  if constexpr (E::nodes == Linear::nodes) {  // nothing is added
    return {from.nodes, {from.template elements<Linear>()}, from.boundaries, from.slaves};
  } else {
    return detail::with_added_nodes<E>(from);
  }
}

}  // namespace pliant::mesh

#pragma once

#include <algorithm>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/element/element.hpp>

namespace pliant::detail {

/// Whether the elements of a body are quadratic, with no node that hangs: then linear ones on the same cells are in their
/// space, as continuous as they are.
template <class Parts>
bool is_quadratic(Parts const& parts) {
  bool all = parts.layout.interpolation.empty();
  parts.for_each_type([&](auto const& table, auto const&) {
    all = all && (table.count() == 0 || std::remove_cvref_t<decltype(table)>::element::degree == 2);
  });
  return all;
}

/// The corners of a body's cells, on the host. Nodes and elements have their internal numbers.
struct CornersOfBody {
  std::vector<Index> node;             // of each corner, ascending
  Interpolation between{};             // of the other nodes, by the linear functions of the cells
  std::vector<double> share;           // (nodes): 1 over the number of elements around
  std::vector<std::vector<Index>> of;  // of each type: (elements, corners)
  std::vector<std::vector<Index>>
      neighbours;  // of each corner: it, and those it shares a cell with

  template <class Parts>
  explicit CornersOfBody(Parts const& parts) {
    auto const nodes = static_cast<std::size_t>(parts.layout.rows);
    std::vector<Index> corner(nodes, -1);  // by node
    share.assign(nodes, 0);
    for_each_type(parts, [&]<Element E>(E, std::vector<Connectivity<E>> const& elements) {
      for (auto const& element : elements) {
        for (Index i : element) share[at(i)] += 1;
        for (std::size_t b = 0; b < E::cell::corners; ++b) corner[at(element[b])] = 0;
      }
    });
    for (double& x : share) x = x > 0 ? 1 / x : 0;
    for (std::size_t i = 0; i < nodes; ++i)
      if (corner[i] == 0) {
        corner[i] = static_cast<Index>(node.size());
        node.push_back(static_cast<Index>(i));
      }

    std::vector<Slave> others(nodes);
    for_each_type(parts, [&]<Element E>(E, std::vector<Connectivity<E>> const& elements) {
      constexpr auto values = linear_at_nodes<E>();
      auto& list = of.emplace_back();
      list.reserve(elements.size() * E::cell::corners);
      for (auto const& element : elements) {
        for (std::size_t b = 0; b < E::cell::corners; ++b) list.push_back(corner[at(element[b])]);
        for (int a = E::cell::corners; a < E::nodes; ++a) {
          Index const i = element[at(a)];
          auto& slave = others[at(i)];
          if (slave.node >= 0 || corner[at(i)] >= 0) continue;
          slave.node = i;
          for (int b = 0; b < E::cell::corners; ++b)
            if (values(a, b) > 0) slave.masters.emplace_back(element[at(b)], values(a, b));
          std::ranges::sort(slave.masters);
        }
      }
    });
    std::erase_if(others, [](Slave const& slave) { return slave.node < 0; });
    between = Interpolation(std::move(others));
    find_neighbours(parts);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// visit(E{}, elements of internal nodes) for each type.
  template <class Parts, class Visit>
  static void for_each_type(Parts const& parts, Visit const& visit) {
    parts.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      auto const& mesh = parts.state.topology->mesh().template elements<E>();
      std::vector<Connectivity<E>> elements;
      elements.reserve(table.user_elements().size());
      for (Index user : table.user_elements()) {
        elements.push_back(mesh[at(user)]);
        for (Index& i : elements.back()) i = parts.layout.internal_of(i);
      }
      visit(E{}, elements);
    });
  }

  void find_neighbours(auto const& parts) {
    neighbours.resize(node.size());
    for (std::size_t c = 0; c < node.size(); ++c) neighbours[c].push_back(static_cast<Index>(c));
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      constexpr auto corners =
          static_cast<std::size_t>(std::remove_cvref_t<decltype(table)>::element::cell::corners);
      auto const& list = of[type++];
      for (std::size_t e = 0; e < list.size(); e += corners)
        for (std::size_t b = 0; b < corners; ++b)
          for (std::size_t c = 0; c < corners; ++c)
            neighbours[at(list[e + b])].push_back(list[e + c]);
    });
    for_each_on_host(static_cast<Index>(node.size()), 1024, [&](Index c) {
      auto& list = neighbours[at(c)];
      std::ranges::sort(list.begin() + 1, list.end());
      list.erase(std::unique(list.begin() + 1, list.end()), list.end());
      list.erase(std::ranges::find(list.begin() + 1, list.end(), c));
    });
  }
};

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/element/linear.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/hilbert.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant {

/// The order in which a body keeps nodes and elements, invisible to the user: nodes lie along a Hilbert
/// curve, elements follow that node of theirs which comes first on it, and nodes are numbered as these elements
/// first touch them. So elements around a node stand together, and a run of elements has few nodes: of 768
/// tetrahedra in a million 251, where a Morton curve through the centres of elements, which cuts cells raggedly,
/// has 303. Tetrahedra that have their longest edge in common with many others, as the parts of a cell do,
/// stay with these: all follow the node of all of them that comes first.
template <Element... Es>
struct Numbering {
  static constexpr std::size_t types = sizeof...(Es);
  std::vector<Index> internal_node;  // by the user's number
  std::vector<Index> user_node;      // by the internal number
  /// Internal elements of internal nodes.
  std::tuple<std::vector<Connectivity<Es>>...> tables;
  std::array<std::vector<Index>, types> user_element;  // by the internal number

  explicit Numbering(Mesh<Es...> const& mesh) : Numbering(mesh, along_curve(mesh)) {}
  /// Of elements in a given order: per type the user's numbers.
  Numbering(Mesh<Es...> const& mesh, std::array<std::vector<Index>, types> order)
      : internal_node(mesh.nodes.size(), -1),
        user_node(mesh.nodes.size()),
        user_element(std::move(order)) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (fill_table<I, Es>(mesh), ...);
      (number_nodes(std::get<I>(tables)), ...);
    }(std::index_sequence_for<Es...>());
    number_others();
  }

 private:
  static std::array<std::vector<Index>, types> along_curve(Mesh<Es...> const& mesh) {
    auto const order = hilbert_order(std::span<Point<Mesh<Es...>::dim> const>(mesh.nodes));
    std::vector<Index> place(order.size());  // by the user's number
    detail::for_each_on_host(static_cast<Index>(order.size()), 16384, [&](Index i) {
      place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
    });
    return {sorted_elements<Es>(mesh, place)...};
  }
  void take(Index user, Index number) {
    internal_node[static_cast<std::size_t>(user)] = number;
    user_node[static_cast<std::size_t>(number)] = user;
  }

  template <Element E>
  static std::vector<Index> sorted_elements(Mesh<Es...> const& mesh,
                                            std::vector<Index> const& place) {
    auto const& elements = mesh.template elements<E>();
    std::vector<Index> first(elements.size());
    detail::for_each_on_host(static_cast<Index>(elements.size()), detail::few_elements(E::nodes),
                             [&](Index e) {
                               first[static_cast<std::size_t>(e)] =
                                   first_on_curve(elements[static_cast<std::size_t>(e)], place);
                             });
    if constexpr (LinearSimplex<E> && E::dim == 3) keep_together(mesh, elements, first);
    auto const order = detail::group_by_key(first, static_cast<Index>(mesh.nodes.size())).order;
    return {order.begin(), order.end()};
  }
  /// Nodes of no element come last.
  void number_others() {
    for (std::size_t i = 0; next_ < static_cast<Index>(internal_node.size()); ++i)
      if (internal_node[i] < 0) take(static_cast<Index>(i), next_++);
  }
  template <std::size_t I, Element E>
  void fill_table(Mesh<Es...> const& mesh) {
    auto const& elements = mesh.template elements<E>();
    auto& table = std::get<I>(tables);
    table.resize(elements.size());
    detail::for_each_on_host(static_cast<Index>(elements.size()), detail::few_elements(E::nodes),
                             [&](Index i) {
                               auto const at = static_cast<std::size_t>(i);
                               table[at] = elements[static_cast<std::size_t>(user_element[I][at])];
                             });
  }

  template <std::size_t Nodes>
  static Index first_on_curve(std::array<Index, Nodes> const& element,
                              std::vector<Index> const& place) {
    Index least = place[static_cast<std::size_t>(element[0])];
    for (Index node : element) least = std::min(least, place[static_cast<std::size_t>(node)]);
    return least;
  }

  /// The ends of an element's longest edge, the lower number first.
  static std::pair<Index, Index> longest_edge(Mesh<Es...> const& mesh,
                                              std::array<Index, 4> const& element) {
    std::pair<Index, Index> ends;
    double longest = -1;
    for (std::size_t b = 1; b < element.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        auto const& x = mesh.nodes[static_cast<std::size_t>(element[a])];
        auto const& y = mesh.nodes[static_cast<std::size_t>(element[b])];
        double length = 0;
        for (std::size_t k = 0; k < 3; ++k) length += (x[k] - y[k]) * (x[k] - y[k]);
        if (length > longest) longest = length, ends = std::minmax(element[a], element[b]);
      }
    return ends;
  }
  /// `first` of elements around an edge that is the longest of several becomes the least of theirs.
  static void keep_together(Mesh<Es...> const& mesh,
                            std::vector<std::array<Index, 4>> const& elements,
                            std::vector<Index>& first) {
    constexpr std::ptrdiff_t several = 5;
    auto const count = static_cast<Index>(elements.size());
    std::vector<Index> one(elements.size()), other(elements.size());
    detail::for_each_on_host(count, detail::few_elements(4), [&](Index e) {
      auto const i = static_cast<std::size_t>(e);
      std::tie(one[i], other[i]) = longest_edge(mesh, elements[i]);
    });
    auto const nodes = static_cast<Index>(mesh.nodes.size());
    auto grouped = detail::group_by_key(one, nodes);
    detail::for_each_on_host(nodes, detail::few_elements(24), [&](Index node) {
      auto const far = [&](Index e) { return other[static_cast<std::size_t>(e)]; };
      auto const begin = grouped.order.begin() + grouped.first[static_cast<std::size_t>(node)];
      auto const end = grouped.order.begin() + grouped.first[static_cast<std::size_t>(node) + 1];
      if (end - begin < several) return;
      std::sort(begin, end, [&](Index d, Index e) { return far(d) < far(e); });
      for (auto from = begin, to = begin; from != end; from = to) {
        Index least = nodes;
        for (; to != end && far(*to) == far(*from); ++to)
          least = std::min(least, first[static_cast<std::size_t>(*to)]);
        if (to - from < several) continue;
        for (auto e = from; e != to; ++e) first[static_cast<std::size_t>(*e)] = least;
      }
    });
  }

  template <std::size_t Nodes>
  void number_nodes(std::vector<std::array<Index, Nodes>>& table) {
    detail::HostParts const parts(static_cast<Index>(table.size()), detail::few_elements(Nodes));
    if (parts.count() > 1 && detail::has_many_host_threads()) return number_in_parts(table, parts);
    for (auto& element : table)
      for (Index& node : element) {
        if (internal_node[static_cast<std::size_t>(node)] < 0) take(node, next_++);
        node = internal_node[static_cast<std::size_t>(node)];
      }
  }
  /// The same on several threads: a part numbers the nodes that no earlier one has, then all know where theirs begin.
  template <std::size_t Nodes>
  void number_in_parts(std::vector<std::array<Index, Nodes>>& table,
                       detail::HostParts<Index> const& parts) {
    // Of each new node, parts.count() less the first part that has it; 0: it is not new.
    std::vector<Index> owner(internal_node.size());
    auto const each_new = [&](Index from, Index to, int part, auto const& visit) {
      Index const own = parts.count() - part;
      for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i)
        for (Index node : table[i]) visit(node, owner[static_cast<std::size_t>(node)], own);
    };
    parts([&](Index from, Index to, int part) {
      each_new(from, to, part, [&](Index node, Index& kept_there, Index own) {
        std::atomic_ref const kept(kept_there);
        auto before = kept.load(std::memory_order_relaxed);
        if (before >= own || internal_node[static_cast<std::size_t>(node)] >= 0) return;
        while (before < own &&
               !kept.compare_exchange_weak(before, own, std::memory_order_relaxed)) {
        }
      });
    });
    std::vector<Index> first(static_cast<std::size_t>(parts.count()));
    parts([&](Index from, Index to, int part) {
      Index count = 0;
      each_new(from, to, part, [&](Index node, Index& kept, Index own) {
        if (kept != own) return;
        Index& number = internal_node[static_cast<std::size_t>(node)];
        if (number < 0) number = count++;
      });
      first[static_cast<std::size_t>(part)] = count;
    });
    for (Index& before : first) next_ += std::exchange(before, next_);
    detail::for_each_on_host(static_cast<Index>(owner.size()), 16384, [&](Index user) {
      auto const i = static_cast<std::size_t>(user);
      if (Index const own = owner[i]; own > 0)
        take(user, internal_node[i] + first[static_cast<std::size_t>(parts.count() - own)]);
    });
    parts([&](Index from, Index to, int) {
      for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i)
        for (Index& node : table[i]) node = internal_node[static_cast<std::size_t>(node)];
    });
  }

  Index next_ = 0;  // internal number
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/element_numbers.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/hilbert.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/topology.hpp>

namespace pliant {

/// Per element type, the first internal node that a block of its elements has and no block before it, and the end of the
/// last one's.
template <std::size_t Types>
using FirstNodes = std::array<std::vector<Index>, Types>;

/// The order in which a body keeps nodes and elements, invisible to the user: nodes lie along a Hilbert
/// curve, elements follow that node of theirs which comes first on it, and nodes are numbered as these elements
/// first touch them. So elements around a node stand together, and a run of elements has few nodes: of 768
/// tetrahedra in a million 251, where a Morton curve through the centres of elements, which cuts cells raggedly,
/// has 303. Tetrahedra that have their longest edge in common with many others, as the parts of a cell do,
/// stay with these: all follow the node of all of them that comes first.
template <Element... Es>
struct Numbering {
  static constexpr std::size_t types = sizeof...(Es);
  template <std::size_t I>
  using TypeAt = std::tuple_element_t<I, std::tuple<Es...>>;
  std::vector<Index> internal_node;  // by the user's number
  std::vector<Index> user_node;      // by the internal number
  /// Internal elements of internal nodes; empty where elements are in blocks: see rows_of.
  std::tuple<std::vector<Connectivity<Es>>...> tables;
  std::array<std::vector<Index>, types> user_element;  // by the internal number; empty as tables
  FirstNodes<types> first_nodes;                       // empty where elements are in no blocks

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
  /// The same of a topology's elements in blocks: per type, the cells of each. Nodes that blocks `keep` keep their order: see
  /// KeptNodes.
  template <class Kept>
  Numbering(Topology<Mesh<Es...>> const& topology,
            std::array<ElementNumbers::Blocks, types> const& blocks, Kept const& kept)
      : internal_node(static_cast<std::size_t>(topology.nodes()), -1),
        user_node(static_cast<std::size_t>(topology.nodes())) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (number_by_blocks<I, Es>(topology, blocks[I], kept), ...);
      (take_kept<I>(kept), ...);
    }(std::index_sequence_for<Es...>());
    number_others();
  }

  /// The table of a type, whose elements are in blocks of these cells: all elements, or those of blocks that do not stay, one
  /// after another.
  template <std::size_t I>
  std::vector<Connectivity<TypeAt<I>>> rows_of(Topology<Mesh<Es...>> const& topology,
                                               ElementNumbers::Blocks const& cells,
                                               ElementBlocks const& blocks, bool all) const {
    auto const& looked_up = std::get<I>(looked_up_);
    std::vector<Index> first{0};  // row, by block
    auto const is_wanted = [&](std::size_t b) {
      return all || !blocks.some_stay() || blocks.stays[b] == 0;
    };
    for (std::size_t b = 0; b + 1 < blocks.first.size(); ++b)
      first.push_back(first.back() + (is_wanted(b) ? blocks.first[b + 1] - blocks.first[b] : 0));
    std::vector<Connectivity<TypeAt<I>>> rows(static_cast<std::size_t>(first.back()));
    constexpr Index few_blocks = 32;  // worth a thread
    detail::for_each_on_host(static_cast<Index>(first.size()) - 1, few_blocks, [&](Index block) {
      auto const b = static_cast<std::size_t>(block);
      auto const begin = static_cast<std::size_t>(first[b]),
                 count = static_cast<std::size_t>(first[b + 1]) - begin;
      Index const known = looked_up.first.empty() ? -1 : looked_up.first[b];
      for (std::size_t k = 0; k < count; ++k) {
        auto& row = rows[begin + k];
        row = known >= 0 ? looked_up.rows[static_cast<std::size_t>(known) + k]
                         : topology.template nodes_of_cell<TypeAt<I>>(cells[b]->cells[k]);
        for (Index& node : row) node = internal_node[static_cast<std::size_t>(node)];
      }
    });
    return rows;
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
    return detail::group_by_key(first, static_cast<Index>(mesh.nodes.size())).order;
  }
  /// Nodes of no element come last.
  void number_others() {
    for (std::size_t i = 0; next_ < static_cast<Index>(internal_node.size()); ++i)
      if (internal_node[i] < 0) take(static_cast<Index>(i), next_++);
  }
  /// Numbers the nodes of blocks that keep none, and tells where those of each block begin.
  template <std::size_t I, Element E, class Kept>
  void number_by_blocks(Topology<Mesh<Es...>> const& topology, ElementNumbers::Blocks const& blocks,
                        Kept const& kept) {
    auto has_kept = kept.has();
    auto& looked_up = std::get<I>(looked_up_);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      first_nodes[I].push_back(next_);
      if (kept.keeps(b)) {
        looked_up.first.push_back(-1);
        next_ += kept.count(I, b);
        continue;
      }
      if (kept.keeps_some(b)) {
        looked_up.first.push_back(-1);
        kept.for_each(I, b, [&](Index user) {
          if (internal_node[static_cast<std::size_t>(user)] < 0) take(user, next_++);
        });
        continue;
      }
      looked_up.first.push_back(static_cast<Index>(looked_up.rows.size()));
      for (Index const c : blocks[b]->cells)
        for (Index const node : looked_up.rows.emplace_back(topology.template nodes_of_cell<E>(c)))
          if (internal_node[static_cast<std::size_t>(node)] < 0 && !has_kept(node))
            take(node, next_++);
    }
    first_nodes[I].push_back(next_);
  }
  template <std::size_t I, class Kept>
  void take_kept(Kept const& kept) {
    constexpr Index few_blocks = 64;  // worth a thread
    detail::for_each_on_host(static_cast<Index>(first_nodes[I].size()) - 1, few_blocks,
                             [&](Index block) {
                               auto const b = static_cast<std::size_t>(block);
                               Index next = first_nodes[I][b];
                               if (kept.keeps(b))
                                 kept.for_each(I, b, [&](Index user) { take(user, next++); });
                             });
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

  /// Elements of blocks, by the user's numbers of nodes, and by the block the first of them; −1: of a block that keeps its
  /// nodes.
  template <Element E>
  struct LookedUp {
    std::vector<Index> first;
    std::vector<Connectivity<E>> rows;
  };
  std::tuple<LookedUp<Es>...> looked_up_;
  Index next_ = 0;  // internal number
};

}  // namespace pliant

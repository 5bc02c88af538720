#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant::detail {

/// What a change of topology touches: the nodes of elements that come or go, those that begin or cease to hang or hang
/// otherwise, and all elements around these. Masses, momentum and strain energy of all others stay as they were.
template <class M>
class TouchedElements {
  static constexpr int dim = M::dim;
  using Origin = typename Transfer<dim>::Origin;

 public:
  struct Staying {
    Index before, after;
  };
  /// Of one type, by the user's numbers, ascending.
  struct OfType {
    std::vector<Index> before, after;
    std::vector<Staying> staying;  // among these
  };

  TouchedElements(Topology<M> const& before, Topology<M> const& after,
                  Transfer<dim> const& transfer)
      : nodes_(after.mesh.nodes.size(), 0) {
    for (auto const& family : transfer.families()) {
      touch(before.mesh, family.before, [&](Index node) { return transfer.renumbered(node); });
      touch(after.mesh, family.after, [](Index node) { return node; });
    }
    touch_slaves(before.interpolation.slaves(), after.interpolation.slaves(), transfer);
    for_each_type_of(after.mesh, [&]<Element E>(E, std::size_t type) {
      list(after.mesh.template elements<E>(), transfer.origins(type));
    });
    for (auto const& family : transfer.families())
      for (auto const& member : family.before) types_[member.type].before.push_back(member.element);
    auto const counts = element_counts(before.mesh);
    for (std::size_t type = 0; type < types_.size(); ++type) {
      auto& own = types_[type];
      for (auto const& element : own.staying) own.before.push_back(element.before);
      own.before = each_once(std::move(own.before), counts[type]);
    }
  }

  /// Whether elements at a node, by its new number, come or go.
  bool changes_elements(Index node) const { return (flags(node) & of_elements) != 0; }
  /// Whether a node hangs otherwise than before.
  bool hangs_otherwise(Index node) const { return (flags(node) & of_slaves) != 0; }
  OfType const& of_type(std::size_t type) const { return types_[type]; }

 private:
  static constexpr char of_elements = 1, of_slaves = 2;

  char flags(Index node) const { return nodes_[static_cast<std::size_t>(node)]; }
  template <class Number>
  void touch(M const& mesh, std::vector<typename Transfer<dim>::Member> const& members,
             Number const& number) {
    for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
      for (auto const& member : members) {
        if (member.type != type) continue;
        for (Index const old :
             mesh.template elements<E>()[static_cast<std::size_t>(member.element)])
          if (Index const node = number(old); node >= 0)
            nodes_[static_cast<std::size_t>(node)] |= of_elements;
      }
    });
  }
  /// Both lists ascend by nodes, which keep their order.
  void touch_slaves(std::vector<Slave> const& before, std::vector<Slave> const& after,
                    Transfer<dim> const& transfer) {
    auto const differ = [&](Slave const& old, Slave const& now) {
      bool same = old.masters.size() == now.masters.size();
      for (std::size_t k = 0; same && k < now.masters.size(); ++k)
        same = transfer.renumbered(old.masters[k].first) == now.masters[k].first &&
               old.masters[k].second == now.masters[k].second;
      return !same;
    };
    auto const mark = [&](Index node) { nodes_[static_cast<std::size_t>(node)] |= of_slaves; };
    auto now = after.begin();
    for (Slave const& old : before) {
      Index const node = transfer.renumbered(old.node);
      if (node < 0) continue;
      for (; now != after.end() && now->node < node; ++now) mark(now->node);
      bool const is_there = now != after.end() && now->node == node;
      if (!is_there || differ(old, *now)) mark(node);
      if (is_there) ++now;
    }
    for (; now != after.end(); ++now) mark(now->node);
  }
  template <std::size_t Nodes>
  void list(std::vector<std::array<Index, Nodes>> const& elements,
            std::vector<Origin> const& origins) {
    std::vector<Index> first;  // element, by origin
    Index count = 0;
    for (Origin const& origin : origins) {
      first.push_back(count);
      count += origin.count;
    }
    HostParts const parts(count, few_elements(Nodes));
    std::vector<OfType> of_parts(static_cast<std::size_t>(parts.count()));
    parts([&](Index from, Index to, int part) {
      auto& own = of_parts[static_cast<std::size_t>(part)];
      auto next = std::ranges::upper_bound(first, from) - first.begin() - 1;
      for (Index e = from; e < to; ++next) {
        Origin const& origin = origins[static_cast<std::size_t>(next)];
        Index const begin = first[static_cast<std::size_t>(next)],
                    end = std::min(to, begin + origin.count);
        for (; e < end; ++e) {
          char any = 0;  // of all nodes, without a branch for each
          for (Index const node : elements[static_cast<std::size_t>(e)]) any |= flags(node);
          bool const stays = origin.child == Origin::same;
          if (stays && any == 0) continue;
          own.after.push_back(e);
          if (stays) own.staying.push_back({origin.element + (e - begin), e});
        }
      }
    });
    auto& own = types_.emplace_back();
    for (auto const& of_part : of_parts) {
      own.after.insert(own.after.end(), of_part.after.begin(), of_part.after.end());
      own.staying.insert(own.staying.end(), of_part.staying.begin(), of_part.staying.end());
    }
  }

  std::vector<char> nodes_;  // by the new number
  std::vector<OfType> types_;
};

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/backend/is_marked.hpp>
#include <pliant/constraint/slave_rows.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant::detail {

/// Marks the nodes of a list.
struct MarkListed {
  Index const* nodes;
  std::uint8_t* marks;
  PLIANT_HOST_DEVICE void operator()(Index i) const { marks[nodes[i]] = 1; }
};

/// Finds a body's elements by their nodes, in the backend's memory.
template <class Parts>
class ElementsAtNodes {
 public:
  /// `nodes`: by the user's numbers.
  ElementsAtNodes(Parts const& parts, std::vector<Index> const& nodes)
      : parts_(parts),
        marks_(zeros<std::uint8_t>(parts.backend, static_cast<std::size_t>(parts.layout.rows))) {
    std::vector<Index> internal;
    internal.reserve(nodes.size());
    for (Index const node : nodes) internal.push_back(parts.layout.internal_of(node));
    auto const listed = upload(parts.backend, internal);
    parts.backend.for_each(static_cast<Index>(internal.size()),
                           MarkListed{listed.data(), marks_.data()});
    parts.backend.synchronize();  // before the list goes
  }
  /// Those of a type that have one of the nodes, by the user's numbers, ascending.
  template <Element E>
  [[nodiscard]] std::vector<Index> of() const {
    auto const& table = parts_.layout.template table<E>();
    auto found = parts_.backend.select(
        table.count(), HasMarkedNode<E::nodes>{table.elements.rows_of_nodes(), marks_.data()});
    for (Index& e : found) e = table.user_element(e);
    return each_once(std::move(found), static_cast<std::size_t>(table.count()));
  }

 private:
  Parts const& parts_;
  typename Parts::template Array<std::uint8_t> marks_;
};

/// Some elements of a mesh, by type: their numbers, which are the user's, and nodes.
template <class M>
struct ElementList {
  std::array<std::vector<Index>, TypesOf<M>::count> numbers;
  decltype(M::tables) tables;

  template <Element E>
  std::vector<Connectivity<E>> const& nodes() const {
    return std::get<std::vector<Connectivity<E>>>(tables);
  }
  template <Element E>
  std::vector<Connectivity<E>>& nodes() {
    return std::get<std::vector<Connectivity<E>>>(tables);
  }
  /// visit(number, nodes) for those of a type.
  template <Element E, class Visit>
  void visit(Visit const& visit_one) const {
    auto const& own = numbers[type_in<E, M>];
    for (std::size_t i = 0; i < own.size(); ++i) visit_one(own[i], nodes<E>()[i]);
  }
};

/// The members of families before a change, or after it, with their nodes, each looked up once. Refers to their topology.
template <class M>
class FamilyNodes {
  using Family = typename Transfer<M::dim>::Family;
  using Member = typename Transfer<M::dim>::Member;

 public:
  FamilyNodes(Topology<M> const& topology, ElementFamilies const& families,
              std::span<Member const> Family::*members)
      : topology_(topology) {
    first_.reserve(families.size() + 1);
    for (Family const& family : families) {
      first_.push_back(places_.size());
      for (Member const& member : family.*members) {
        auto& numbers = members_.numbers[member.type];
        places_.push_back({member.type, numbers.size()});
        numbers.push_back(member.element);
      }
    }
    first_.push_back(places_.size());
    for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
      auto const& numbers = members_.numbers[type];
      auto& nodes = members_.template nodes<E>();
      nodes.resize(numbers.size());
      for_each_on_host(static_cast<Index>(numbers.size()), few_members, [&](Index k) {
        auto const i = static_cast<std::size_t>(k);
        nodes[i] = topology.template nodes_of<E>(numbers[i]);
      });
    });
  }

  [[nodiscard]] Topology<M> const& topology() const { return topology_; }
  /// Of all families.
  ElementList<M> const& members() const { return members_; }
  /// visit(E{}, nodes) for a member of a family.
  template <class Visit>
  void visit(std::size_t family, std::size_t member, Visit const& visit_one) const {
    Place const place = places_[first_[family] + member];
    for_each_type_of<M>([&]<Element E>(E element, std::size_t type) {
      if (type == place.type) visit_one(element, members_.template nodes<E>()[place.among_them]);
    });
  }
  /// The same for all members of a family.
  template <class Visit>
  void visit_all(std::size_t family, Visit const& visit_one) const {
    for (std::size_t k = 0; k < first_[family + 1] - first_[family]; ++k)
      visit(family, k, visit_one);
  }
  /// The same for those of all families, type by type.
  template <class Visit>
  void visit_all(Visit const& visit_one) const {
    for_each_type_of<M>([&]<Element E>(E element, std::size_t) {
      for (auto const& nodes : members_.template nodes<E>()) visit_one(element, nodes);
    });
  }

 private:
  static constexpr Index few_members = 1024;
  struct Place {
    std::size_t type, among_them;
  };

  Topology<M> const& topology_;
  std::vector<std::size_t> first_;  // member, by family
  std::vector<Place> places_;       // by member, in the list
  ElementList<M> members_;
};

/// What a change of topology touches: the nodes of elements that come or go, those that begin or cease to hang or hang
/// otherwise, and elements that stay, but at nodes that are displaced, as they hang otherwise now. Strain energies of
/// all others stay as they were.
template <class M>
class TouchedElements {
  static constexpr int dim = M::dim;
  using Origin = typename Transfer<dim>::Origin;
  using Family = typename Transfer<dim>::Family;

 public:
  /// find(nodes) gives what has of<E>(): the elements of a type before the change that have one of these nodes, ascending. It
  /// is not called where no node is displaced.
  template <class Find>
  TouchedElements(Topology<M> const& before, Topology<M> const& after,
                  Transfer<dim> const& transfer, Find const& find)
      : nodes_(static_cast<std::size_t>(after.nodes()), 0),
        old_numbers_(transfer.old_numbers()),
        families_before_(before, transfer.families(), &Family::before),
        families_after_(after, transfer.families(), &Family::after) {
    families_before_.visit_all([&](auto, auto const& nodes) {
      for (Index const old : nodes)
        if (Index const node = transfer.renumbered(old); node >= 0) touch(node, of_elements);
    });
    families_after_.visit_all([&](auto, auto const& nodes) {
      for (Index const node : nodes) touch(node, of_elements);
    });
    auto const displaced =
        touch_slaves(before.interpolation.slaves(), after.interpolation.slaves(), transfer);
    if (displaced.empty()) return;
    displaces_ = true;
    auto const at_nodes = find(displaced);
    for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
      list_staying<E>(before, after, at_nodes.template of<E>(), transfer.origins(type));
    });
  }

  /// The number before of a node that stays.
  Index old_number(Index node) const { return old_numbers_[node]; }
  /// Whether elements at a node, by its new number, come or go.
  bool changes_elements(Index node) const { return (flags(node) & of_elements) != 0; }
  /// Whether a node hangs otherwise than before.
  bool hangs_otherwise(Index node) const { return (flags(node) & of_slaves) != 0; }
  /// Whether nodes that stay are displaced.
  bool displaces() const { return displaces_; }
  /// All such nodes, by their new numbers.
  std::vector<Index> const& nodes() const { return touched_; }
  FamilyNodes<M> const& families_before() const { return families_before_; }
  FamilyNodes<M> const& families_after() const { return families_after_; }
  /// visit(number, nodes) for each element of a type before the change of which the strain energy does not stay as it was.
  template <Element E, class Visit>
  void visit_before(Visit const& visit) const {
    families_before_.members().template visit<E>(visit);
    staying_before_.template visit<E>(visit);
  }
  /// The same after it.
  template <Element E, class Visit>
  void visit_after(Visit const& visit) const {
    families_after_.members().template visit<E>(visit);
    staying_after_.template visit<E>(visit);
  }

 private:
  static constexpr char of_elements = 1, of_slaves = 2;

  bool displaces_ = false;
  char flags(Index node) const { return nodes_[static_cast<std::size_t>(node)]; }
  void touch(Index node, char by) {
    char& own = nodes_[static_cast<std::size_t>(node)];
    if (own == 0) touched_.push_back(node);
    own |= by;
  }
  /// Both lists ascend by nodes, which keep their order. Gives the nodes that stay and are slaves that they were not, by
  /// their old numbers: others have the displacement that they had.
  std::vector<Index> touch_slaves(SlaveRows const& before, SlaveRows const& after,
                                  Transfer<dim> const& transfer) {
    auto const differ = [&](SlaveRow const& old, SlaveRow const& now) {
      bool same = old.masters.size() == now.masters.size();
      for (std::size_t k = 0; same && k < now.masters.size(); ++k)
        same = transfer.renumbered(old.masters[k].first) == now.masters[k].first &&
               old.masters[k].second == now.masters[k].second;
      return !same;
    };
    std::vector<Index> displaced;
    auto const mark = [&](SlaveRow const& now) {
      touch(now.node, of_slaves);
      if (now.node < transfer.staying_nodes()) displaced.push_back(old_number(now.node));
    };
    auto now = after.begin();
    for (SlaveRow const& old : before) {
      Index const node = transfer.renumbered(old.node);
      if (node < 0) continue;
      for (; now != after.end() && (*now).node < node; ++now) mark(*now);
      if (now == after.end() || (*now).node != node) {
        touch(node, of_slaves);
        continue;
      }
      if (differ(old, *now)) mark(*now);
      ++now;
    }
    for (; now != after.end(); ++now) mark(*now);
    return displaced;
  }
  /// `at_nodes`: elements before the change, ascending.
  template <Element E>
  void list_staying(Topology<M> const& before, Topology<M> const& after,
                    std::vector<Index> const& at_nodes, std::vector<Origin> const& origins) {
    constexpr std::size_t type = type_in<E, M>;
    Index e = 0;
    auto old = at_nodes.begin();
    for (Origin const& origin : origins) {
      if (origin.child == Origin::same) {
        old = std::lower_bound(old, at_nodes.end(), origin.element);
        for (; old != at_nodes.end() && *old < origin.element + origin.count; ++old) {
          Index const now = e + (*old - origin.element);
          staying_before_.numbers[type].push_back(*old);
          staying_before_.template nodes<E>().push_back(before.template nodes_of<E>(*old));
          staying_after_.numbers[type].push_back(now);
          staying_after_.template nodes<E>().push_back(after.template nodes_of<E>(now));
        }
      }
      e += origin.count;
    }
  }

  std::vector<char> nodes_;     // by the new number
  std::vector<Index> touched_;  // nodes, by the new number
  NumberMap old_numbers_;
  FamilyNodes<M> families_before_, families_after_;
  ElementList<M> staying_before_, staying_after_;  // in the same order
};

}  // namespace pliant::detail

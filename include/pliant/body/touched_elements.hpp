#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant::detail {

/// Whether an element has a marked node.
template <int Nodes>
struct HasMarkedNode {
  ElementRows rows;
  std::uint8_t const* marks;  // by node

  PLIANT_HOST_DEVICE bool operator()(Index e) const {
    Index const* const nodes = rows[e];
    std::uint8_t any = 0;  // of all nodes, without a branch for each
    for (int a = 0; a < Nodes; ++a) any |= marks[nodes[a]];
    return any != 0;
  }
};
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
    for (Index& e : found) e = table.numbers[e];
    return each_once(std::move(found), table.numbers.size());
  }

 private:
  Parts const& parts_;
  typename Parts::template Array<std::uint8_t> marks_;
};

/// The nodes of the members of families, each looked up once. Refers to their topology.
template <class M>
class FamilyNodes {
  using Member = typename Transfer<M::dim>::Member;

 public:
  explicit FamilyNodes(Topology<M> const& topology) : topology_(topology) {}
  [[nodiscard]] Topology<M> const& topology() const { return topology_; }
  void reserve(std::size_t families, std::size_t members) {
    first_.reserve(families);
    types_.reserve(members);
    places_.reserve(members);
    std::apply([&](auto&... rows) { (rows.reserve(members / sizeof...(rows)), ...); }, rows_);
  }
  void add(std::vector<Member> const& members) {
    first_.push_back(types_.size());
    for (auto const& member : members)
      visit_member(topology_, member, [&]<Element E>(E, Connectivity<E> const& nodes) {
        auto& rows = std::get<std::vector<Connectivity<E>>>(rows_);
        types_.push_back(member.type);
        places_.push_back(rows.size());
        rows.push_back(nodes);
      });
  }
  /// visit(E{}, nodes) for a member of a family.
  template <class Visit>
  void visit(std::size_t family, std::size_t member, Visit const& visit) const {
    std::size_t const k = first_[family] + member;
    for_each_type_of<M>([&]<Element E>(E element, std::size_t type) {
      if (types_[k] == type) visit(element, rows<E>()[places_[k]]);
    });
  }
  /// The same for all members of a family.
  template <class Visit>
  void visit_all(std::size_t family, Visit const& visit_one) const {
    std::size_t const end = family + 1 < first_.size() ? first_[family + 1] : types_.size();
    for (std::size_t k = 0; k < end - first_[family]; ++k) visit(family, k, visit_one);
  }
  /// The nodes of a member that is of type E.
  template <Element E>
  Connectivity<E> const& nodes_of(std::size_t family, std::size_t member) const {
    return rows<E>()[places_[first_[family] + member]];
  }

 private:
  template <Element E>
  std::vector<Connectivity<E>> const& rows() const {
    return std::get<std::vector<Connectivity<E>>>(rows_);
  }
  Topology<M> const& topology_;
  std::vector<std::size_t> first_;           // member, by family
  std::vector<std::size_t> types_, places_;  // of members, and in the rows of their types
  decltype(M::tables) rows_;
};

/// What a change of topology touches: the nodes of elements that come or go, those that begin or cease to hang or hang
/// otherwise, and all elements around these. Masses, momentum and strain energy of all others stay as they were.
template <class M>
class TouchedElements {
  static constexpr int dim = M::dim;
  using Origin = typename Transfer<dim>::Origin;

 public:
  struct Staying {
    Index before, after;
    std::size_t place;  // in the list of those after
  };
  /// Of one type, by the user's numbers, ascending.
  struct OfType {
    std::vector<Index> before, after;
    std::vector<Staying> staying;  // among these
  };

  /// find(nodes) gives what has of<E>(): the elements of a type before the change that have one of these nodes, ascending.
  template <class Find>
  TouchedElements(Topology<M> const& before, Topology<M> const& after,
                  Transfer<dim> const& transfer, Find const& find)
      : nodes_(static_cast<std::size_t>(after.nodes()), 0),
        old_numbers_(transfer.old_numbers()),
        families_before_(before),
        families_after_(after) {
    auto const reserve = [&](FamilyNodes<M>& nodes, auto const& members_of) {
      std::size_t members = 0;
      for (auto const& family : transfer.families()) members += members_of(family).size();
      nodes.reserve(transfer.families().size(), members);
    };
    reserve(families_before_, [](auto const& family) -> auto& { return family.before; });
    reserve(families_after_, [](auto const& family) -> auto& { return family.after; });
    for (std::size_t f = 0; auto const& family : transfer.families()) {
      families_before_.add(family.before);
      families_after_.add(family.after);
      families_before_.visit_all(f, [&](auto, auto const& nodes) {
        for (Index const old : nodes)
          if (Index const node = transfer.renumbered(old); node >= 0) touch(node, of_elements);
      });
      families_after_.visit_all(f++, [&](auto, auto const& nodes) {
        for (Index const node : nodes) touch(node, of_elements);
      });
    }
    touch_slaves(before.interpolation.slaves(), after.interpolation.slaves(), transfer);
    std::vector<Index> old;
    for (Index const node : touched_)
      if (node < transfer.staying_nodes()) old.push_back(old_number(node));
    auto const at_nodes = find(old);
    for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
      list<E>(after, at_nodes.template of<E>(), transfer.origins(type));
    });
    for (auto const& family : transfer.families())
      for (auto const& member : family.before) types_[member.type].before.push_back(member.element);
    auto const counts = before.counts();
    for (std::size_t type = 0; type < types_.size(); ++type) {
      auto& own = types_[type];
      for (auto const& element : own.staying) own.before.push_back(element.before);
      own.before = each_once(std::move(own.before), counts[type]);
    }
    for_each_type_of<M>(
        [&]<Element E>(E, std::size_t type) { look_up_before<E>(before, types_[type]); });
  }

  /// The number before of a node that stays.
  Index old_number(Index node) const {
    return old_numbers_.empty() ? node : old_numbers_[static_cast<std::size_t>(node)];
  }
  /// Whether elements at a node, by its new number, come or go.
  bool changes_elements(Index node) const { return (flags(node) & of_elements) != 0; }
  /// Whether a node hangs otherwise than before.
  bool hangs_otherwise(Index node) const { return (flags(node) & of_slaves) != 0; }
  /// All such nodes, by their new numbers.
  std::vector<Index> const& nodes() const { return touched_; }
  /// The nodes of the elements of a type in its lists, by the numbers before and after.
  template <Element E>
  std::vector<Connectivity<E>> const& nodes_before() const {
    return std::get<std::vector<Connectivity<E>>>(rows_before_);
  }
  template <Element E>
  std::vector<Connectivity<E>> const& nodes_after() const {
    return std::get<std::vector<Connectivity<E>>>(rows_after_);
  }
  OfType const& of_type(std::size_t type) const { return types_[type]; }
  FamilyNodes<M> const& families_before() const { return families_before_; }
  FamilyNodes<M> const& families_after() const { return families_after_; }

 private:
  static constexpr char of_elements = 1, of_slaves = 2;

  char flags(Index node) const { return nodes_[static_cast<std::size_t>(node)]; }
  void touch(Index node, char by) {
    char& own = nodes_[static_cast<std::size_t>(node)];
    if (own == 0) touched_.push_back(node);
    own |= by;
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
    auto const mark = [&](Index node) { touch(node, of_slaves); };
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
  /// `at_nodes`: elements before the change at touched nodes, ascending.
  template <Element E>
  void list(Topology<M> const& after, std::vector<Index> const& at_nodes,
            std::vector<Origin> const& origins) {
    auto& own = types_.emplace_back();
    auto& rows = std::get<std::vector<Connectivity<E>>>(rows_after_);
    Index e = 0;
    auto old = at_nodes.begin();
    for (Origin const& origin : origins) {
      if (origin.child == Origin::same) {
        old = std::lower_bound(old, at_nodes.end(), origin.element);
        for (; old != at_nodes.end() && *old < origin.element + origin.count; ++old) {
          own.staying.push_back({*old, e + (*old - origin.element), own.after.size()});
          own.after.push_back(own.staying.back().after);
          rows.push_back(after.template nodes_of<E>(own.after.back()));
        }
      } else {
        own.after.push_back(e);
        rows.push_back(families_after_.template nodes_of<E>(
            static_cast<std::size_t>(origin.family),
            static_cast<std::size_t>(std::max(origin.child, 0))));
      }
      e += origin.count;
    }
  }
  /// Elements that stay have the same nodes, by other numbers.
  template <Element E>
  void look_up_before(Topology<M> const& before, OfType const& own) {
    auto const& after = std::get<std::vector<Connectivity<E>>>(rows_after_);
    auto& rows = std::get<std::vector<Connectivity<E>>>(rows_before_);
    rows.reserve(own.before.size());
    auto staying = own.staying.begin();
    for (Index const e : own.before) {
      if (staying == own.staying.end() || staying->before != e) {
        rows.push_back(before.template nodes_of<E>(e));
        continue;
      }
      auto& row = rows.emplace_back(after[staying++->place]);
      for (Index& node : row) node = old_number(node);
    }
  }

  std::vector<char> nodes_;     // by the new number
  std::vector<Index> touched_;  // nodes, by the new number
  std::vector<Index> old_numbers_;
  std::vector<OfType> types_;
  decltype(M::tables) rows_before_, rows_after_;
  FamilyNodes<M> families_before_, families_after_;
};

}  // namespace pliant::detail

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/error.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/element_families.hpp>
#include <pliant/topology/facet_transfer.hpp>
#include <pliant/topology/number_map.hpp>
#include <pliant/topology/weighted_nodes.hpp>

namespace pliant {

/// What a change of topology means for fields: where new nodes, elements and facets come from, and what
/// becomes of those that go. All numbers are the user's. Nodes that stay keep their order, new ones follow. Values
/// of elements that are divided go to all of their children; merged elements have the mean of their
/// children's by volume, and of groups and other integers the most frequent (of equal ones the first).
template <int Dim>
class Transfer {
 public:
  using NewNode = pliant::NewNode;
  /// Where an element comes from: the number of an old element (of merged ones the first), and which of its
  /// children it is.
  struct Origin {
    Index element;
    int child;          ///< 0 and up, or one of these
    Index family = -1;  ///< of a child, or merged elements: its place among the families
    Index type = -1;    ///< of that old element, its place among the mesh's; −1: the same type
    Index count = 1;    ///< of elements that follow each other as before, of which it is the first
    static constexpr int same = -1;       ///< it is that element
    static constexpr int merged = -2;     ///< it was that element's family
    static constexpr int converted = -3;  ///< it is that element of another type on the same cell
  };
  using Member = ElementFamilies::Member;
  using Family = ElementFamilies::Family;
  struct Parts {
    Index old_nodes = 0;
    NumberMap renumbered{};     ///< nodes, by the old number
    WeightedNodes new_nodes{};  ///< by new numbers, ascending; parents may be new, but before
    WeightedNodes gone{};       ///< by old numbers
    std::vector<std::size_t> old_elements{};     ///< by type
    std::vector<std::vector<Origin>> origins{};  ///< by type, in the new order; see Origin::count
    ElementFamilies families{};
    std::vector<DividedFacet<Dim>> divided{};  ///< by new numbers
    std::vector<DividedFacet<Dim>> merged{};   ///< by old numbers
  };

  explicit Transfer(Parts parts)
      : p_(std::move(parts)), facets_(std::move(p_.divided), std::move(p_.merged)) {
    stay_ = p_.old_nodes;
    if (!renumbers()) return;
    first_moved_ = p_.renumbered.first();
    stay_ = first_moved_ + static_cast<Index>(std::ranges::count_if(
                               p_.renumbered.others(), [](Index node) { return node >= 0; }));
    while (first_moved_ < stay_ && renumbered(first_moved_) == first_moved_) ++first_moved_;
  }

  Index old_nodes() const { return p_.old_nodes; }
  Index nodes() const { return stay_ + static_cast<Index>(p_.new_nodes.size()); }
  /// How many nodes stay: new ones follow them.
  Index staying_nodes() const { return stay_; }
  /// The old numbers of nodes that stay, by the new ones.
  NumberMap old_numbers() const { return p_.renumbered.inverse(); }
  /// Whether parts of the mesh went, so that others may have other numbers.
  bool renumbers() const { return !p_.renumbered.keeps_all(); }
  /// Where it does, nodes before this one stay, and keep their numbers.
  Index first_renumbered() const { return first_moved_; }
  WeightedNodes const& new_nodes() const { return p_.new_nodes; }
  /// Nodes that go, by old numbers, as weighted sums over nodes that stay.
  WeightedNodes const& gone() const { return p_.gone; }
  /// The new number of an old node, or −1 where it goes.
  Index renumbered(Index node) const { return p_.renumbered[node]; }
  /// Of the elements of one type (its place among the mesh's), in the new order; one entry for those that follow each
  /// other as they did before.
  std::vector<Origin> const& origins(std::size_t type = 0) const { return p_.origins[type]; }
  /// How many elements a type had, and has.
  std::size_t old_elements(std::size_t type = 0) const { return p_.old_elements[type]; }
  std::size_t elements(std::size_t type = 0) const {
    std::size_t count = 0;
    for (Origin const& origin : origins(type)) count += static_cast<std::size_t>(origin.count);
    return count;
  }
  ElementFamilies const& families() const { return p_.families; }

  /// Values per node (numbers or points) on the new mesh: new nodes take the weighted sum. Throws Error for an
  /// array that is not of the mesh before.
  template <class V>
  std::vector<V> carry_nodes(std::vector<V> values) const {
    check_nodes(values);
    values = those_that_stay(std::move(values));
    values.resize(static_cast<std::size_t>(nodes()));
    fill_new_nodes(values);
    return values;
  }
  /// Gives new nodes their weighted sums, where `values`[node], by the new numbers, has those of their parents that stay.
  template <class Values>
  void fill_new_nodes(Values& values) const {
    using V = std::remove_cvref_t<decltype(values[std::size_t{0}])>;
    for (NewNode const& n : p_.new_nodes) {
      V const first = values[static_cast<std::size_t>(n.parents[0].first)];
      bool same = true;  // what all have is not rounded
      V sum{};
      for (auto const& [parent, weight] : n.parents) {
        V const& value = values[static_cast<std::size_t>(parent)];
        same = same && value == first;
        add(sum, weight, value);
      }
      values[static_cast<std::size_t>(n.node)] = same ? first : sum;
    }
  }
  /// Sums per node (forces, masses, impulses) on the new mesh: nodes that go hand theirs to those they lay between,
  /// new ones have none, and the total stays. Throws Error as carry_nodes.
  template <class V>
  std::vector<V> carry_sums(std::vector<V> values) const {
    check_nodes(values);
    for (NewNode const& n : p_.gone)
      for (auto const& [parent, weight] : n.parents)
        add(values[static_cast<std::size_t>(parent)], weight,
            values[static_cast<std::size_t>(n.node)]);
    values = those_that_stay(std::move(values));
    values.resize(static_cast<std::size_t>(nodes()), V{});
    return values;
  }
  /// Values per element of one type on the new mesh: `width` each, side by side. Throws Error as carry_nodes, and where
  /// elements come from another type.
  template <class V>
  std::vector<V> carry_elements(std::vector<V> const& values, std::size_t type = 0,
                                std::size_t width = 1) const {
    check(values.size(), p_.old_elements[type] * width, "elements");
    return carry_from(type, width, [&](std::size_t old_type) -> std::vector<V> const& {
      if (old_type != type)
        throw Error("transfer: elements of type ", type, " come from type ", old_type,
                    "; give the values of all types");
      return values;
    });
  }
  /// The same where elements may come from other types: `values` has a list of each. Lists of types that none comes from
  /// are not looked at.
  template <class V>
  std::vector<V> carry_elements(std::vector<std::vector<V>> const& values, std::size_t type,
                                std::size_t width = 1) const {
    return carry_from(type, width, [&](std::size_t old_type) -> std::vector<V> const& {
      return values[old_type];
    });
  }
  /// The same by `values_of`(type): the list of an old type.
  template <class ValuesOf>
  auto carry_elements_from(ValuesOf const& values_of, std::size_t type,
                           std::size_t width = 1) const {
    return carry_from(type, width, values_of);
  }
  /// Whether elements of a type come from another one.
  bool comes_from(std::size_t type, std::size_t old_type) const {
    auto const is_of = [](std::size_t wanted) {
      return [wanted](Member const& member) { return member.type == wanted; };
    };
    return std::ranges::any_of(p_.families, [&](Family const& family) {
      return std::ranges::any_of(family.after, is_of(type)) &&
             std::ranges::any_of(family.before, is_of(old_type));
    });
  }
  /// Facets of the boundary, or such as the mesh, a condition or a pressure names, on the new mesh: a facet that was divided gives way to its parts, and parts that were
  /// merged to the whole, in the place of the first. Throws Error where not all of them are there.
  std::vector<Facet<Dim>> carry_facets(std::vector<Facet<Dim>> const& facets) const {
    auto changed = changed_facets(facets);
    return changed ? std::move(*changed) : facets;
  }
  /// The same; nothing where all facets stay, with the same numbers of nodes.
  std::optional<std::vector<Facet<Dim>>> changed_facets(
      std::vector<Facet<Dim>> const& facets) const {
    return facets_.carry(facets, p_.renumbered);
  }
  /// Those of the facets that are merged while others of their whole are not among them.
  std::vector<Facet<Dim>> cut_facets(std::vector<Facet<Dim>> const& facets) const {
    return facets_.cut(facets);
  }

 private:
  static void check(std::size_t got, std::size_t wanted, char const* what) {
    if (got != wanted)
      throw Error("transfer: got ", got, " values of ", what, ", but those before the change take ",
                  wanted, "; give the arrays from before it");
  }
  void check_nodes(auto const& values) const {
    check(values.size(), static_cast<std::size_t>(p_.old_nodes), "nodes");
  }
  /// As devices do: see fill_new_nodes of a backend.
  static void add(double& sum, double weight, double value) {
    using S = Uncontracted;
    sum = (S(sum) + S(weight) * S(value)).value;
  }
  static void add(float& sum, double weight, float value) {
    sum += static_cast<float>(weight) * value;
  }
  template <class V, std::size_t N>
  static void add(std::array<V, N>& sum, double weight, std::array<V, N> const& value) {
    for (std::size_t k = 0; k < N; ++k) add(sum[k], weight, value[k]);
  }

  template <class V>
  std::vector<V> those_that_stay(std::vector<V> values) const {
    for (Index old = p_.renumbered.first(); old < p_.old_nodes; ++old)
      if (Index const now = renumbered(old); now >= 0)
        values[static_cast<std::size_t>(now)] = values[static_cast<std::size_t>(old)];
    values.resize(static_cast<std::size_t>(stay_));
    values.reserve(static_cast<std::size_t>(nodes()));
    return values;
  }
  /// `values_of`(type): the list of an old type.
  template <class ValuesOf>
  auto carry_from(std::size_t type, std::size_t width, ValuesOf const& values_of) const {
    using Values = std::remove_cvref_t<decltype(values_of(type))>;
    Values carried;
    carried.reserve(elements(type) * width);
    std::vector<Values const*> lists(p_.old_elements.size(), nullptr);
    auto const values_of_type = [&](std::size_t old_type) -> Values const& {
      if (lists[old_type] == nullptr) {
        lists[old_type] = &values_of(old_type);
        check(lists[old_type]->size(), p_.old_elements[old_type] * width, "elements");
      }
      return *lists[old_type];
    };
    for (Origin const& origin : origins(type)) {
      auto const& values =
          values_of_type(origin.type < 0 ? type : static_cast<std::size_t>(origin.type));
      if (origin.child == Origin::merged) {
        for (std::size_t k = 0; k < width; ++k)
          carried.push_back(
              merged_value<typename Values::value_type>(values_of_type, origin, width, k));
        continue;
      }
      auto const first =
          values.begin() + static_cast<std::ptrdiff_t>(width) * std::ptrdiff_t{origin.element};
      carried.insert(carried.end(), first,
                     first + static_cast<std::ptrdiff_t>(width) * std::ptrdiff_t{origin.count});
    }
    return carried;
  }
  template <class V, class ValuesOf>
  V merged_value(ValuesOf const& values_of, Origin const& origin, std::size_t width,
                 std::size_t k) const {
    Family const family = p_.families[static_cast<std::size_t>(origin.family)];
    auto const value_of = [&](std::size_t child) -> decltype(auto) {
      auto const& [type, element] = family.before[child];
      return values_of(type)[width * static_cast<std::size_t>(element) + k];
    };
    if constexpr (std::is_integral_v<V> || std::is_enum_v<V>) {
      std::size_t best = 0;
      std::ptrdiff_t most = 0;
      for (std::size_t i = 0; i < family.before.size(); ++i) {
        std::ptrdiff_t count = 0;
        for (std::size_t j = 0; j < family.before.size(); ++j) count += value_of(j) == value_of(i);
        if (count > most) {
          most = count;
          best = i;
        }
      }
      return value_of(best);
    } else {
      bool same = true;  // what all have is not rounded
      V sum{};
      for (std::size_t i = 0; i < family.before.size(); ++i) {
        same = same && value_of(i) == value_of(0);
        add(sum, family.shares[i], value_of(i));
      }
      return same ? V(value_of(0)) : sum;
    }
  }

  Parts p_;
  Index stay_ = 0, first_moved_ = 0;
  FacetTransfer<Dim> facets_;
};

}  // namespace pliant

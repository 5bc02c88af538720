#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/formulation/mass.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/cell_changes.hpp>
#include <pliant/topology/cell_set.hpp>
#include <pliant/topology/element_families.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

// What becomes of the elements of a mesh when the cells of its tree change.
namespace pliant {

/// What laws read per element: how many values elements of each type have, and which of an old type's those are that an
/// element takes along into another type: by type and old type, for each value its place; −1 where that has none. Then, by
/// type, what sets values of a new element by the mean of its nodes at rest, m: empty where nothing does.
template <int Dim>
struct ElementValues {
  std::vector<std::size_t> widths;
  std::vector<std::vector<std::vector<int>>> places;
  std::vector<std::function<void(Point<Dim> const&, std::span<double> values)>> set_by_place;
};

namespace detail {

/// The elements of a type after a change.
template <int Dim>
struct ChangedElements {
  CellSet cells;
  std::vector<typename Transfer<Dim>::Origin> origins;
};

/// What becomes of the elements of a mesh, types of which are the cells `old_cells` of a tree.
template <class M>
class ElementChanges {
  static constexpr int dim = M::dim;
  using Origin = typename Transfer<dim>::Origin;
  using Member = typename Transfer<dim>::Member;

 public:
  ElementChanges(std::vector<CellSet> const& old_cells, Hierarchy<dim> const& before,
                 std::vector<Index> const& merged, ChangedCells<dim> const& changed)
      : old_cells_(old_cells), before_(before), after_(*changed.tree), changed_(changed) {
    for_each_type_of<M>([&]<Element E>(E, std::size_t) {
      types_.emplace_back(kind_of<typename E::cell>, nodes_on_cell<E>);
    });
    auto const& [parents, split] = std::tie(changed.refinement.parents, changed.split);
    if (!parents.empty() || !split.empty())
      old_numbers_ = changed.coarsening.renumbered.cells.inverse();
    first_converted_ = merged.size();
    first_divided_ = first_converted_ + changed.converted.size();
    first_split_ = first_divided_ + parents.size();
    families_ = ElementFamilies(first_split_ + split.size(), few,
                                [&](std::size_t f) { return shape_of(f, merged); });
    HostParts const parts(static_cast<Index>(families_.size()), few);
    leaving_.resize(at(parts.count()));
    parts([&](Index from, Index to, int part) {
      std::vector<Leaving> leaving(types_.size());
      for (auto f = at(from); f < at(to); ++f) fill_before(f, merged, leaving);
      leaving_[at(part)] = std::move(leaving);
    });
    for (std::size_t k = 0; k < merged.size(); ++k) list_arriving(merged[k], Origin::merged, k);
    for (std::size_t k = 0; k < changed.converted.size(); ++k)
      list_arriving(changed.converted[k], Origin::converted, first_converted_ + k);
    std::ranges::sort(arriving_, {}, &Arriving::cell);
  }

  /// Those of a type after the change.
  template <Element E>
  ChangedElements<dim> of(std::size_t type) {
    auto const& old_cells = old_cells_[type];
    auto const leaving = leaving_from(type);
    auto const children = children_of<E>();
    ChangedElements<dim> list;
    list.origins.reserve(leaving.elements.size() + 2 * arriving_.size() + at(children.back()) + 1);
    // Numbers of cells stay in order, and those of new ones follow.
    Index next = 0, count = 0;  // of the old elements, and how many there are so far
    auto const add_those_before = [&](Index end) {
      if (next == end) return;
      list.origins.push_back({.element = next, .child = Origin::same, .count = end - next});
      count += end - next;
      next = end;
    };
    auto left = leaving.elements.begin();
    auto const add_until = [&](Index end) {
      for (; left != leaving.elements.end() && *left < end; ++left) {
        add_those_before(*left);
        next = *left + 1;
      }
      add_those_before(std::max(next, end));
    };
    std::vector<Index> new_cells;
    for (auto const& own : arriving_) {
      if (!is_cell_of<E>(after_.cell(own.cell))) continue;
      add_until(old_cells.rank(own.old));
      list.origins.push_back(origin_of(type, own.child, own.family, count++));
      new_cells.push_back(own.cell);
    }
    add_until(static_cast<Index>(old_cells.size()));
    auto const first_origin = list.origins.size(), first_cell = new_cells.size();
    list.origins.resize(first_origin + at(children.back()));
    new_cells.resize(first_cell + at(children.back()));
    for_each_on_host(static_cast<Index>(children.size()) - 1, few, [&](Index k) {
      auto const family = first_divided_ + at(k);
      auto place = at(children[at(k)]);
      for_each_child<E>(family, [&](Index cell, int child) {
        new_cells[first_cell + place] = cell;
        list.origins[first_origin + place] =
            origin_of(type, child, family, count + static_cast<Index>(place));
        ++place;
      });
    });
    list.cells = old_cells.changed(
        leaving.cells, changed_.first_renumbered(), [&](Index c) { return changed_.renumbered(c); },
        new_cells);
    return list;
  }

  /// Complete once `of` was asked for each type.
  ElementFamilies families() && { return std::move(families_); }

 private:
  /// A cell that becomes an element: its new number, its family and, as of Origin, its place there.
  struct Arriving {
    Index cell;
    int child;
    std::size_t family;
    Index old;  // its number before
  };

  /// Elements of a type that go or are divided, and their cells, by the old numbers.
  struct Leaving {
    std::vector<Index> elements, cells;
  };
  static constexpr Index few = 512;  // families, or divided cells, that are worth a thread

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// The element that a cell was before.
  Member old_element(Index cell, std::vector<Leaving>& leaving) const {
    auto const& own = before_.cell(cell);
    auto const type = static_cast<std::size_t>(
        std::ranges::find(types_, std::pair(own.kind, own.has)) - types_.begin());
    Index const element = old_cells_[type].rank(cell);
    leaving[type].cells.push_back(cell);
    leaving[type].elements.push_back(element);
    return {type, element};
  }
  ElementFamilies::Shape shape_of(std::size_t f, std::vector<Index> const& merged) const {
    bool const merges = f < first_converted_;
    if (!merges && f < first_divided_)
      return {.mirrored = before_.cell(changed_.converted[f - first_converted_]).mirrored};
    auto const& cell = merges ? before_.cell(merged[f]) : after_.cell(divided(f));
    auto const& pattern = cell.divided();
    return {.before = merges ? at(pattern.children) : 1,
            .after = merges ? 1 : at(pattern.children),
            .pattern = &pattern,
            .mirrored = cell.mirrored};
  }
  void fill_before(std::size_t f, std::vector<Index> const& merged, std::vector<Leaving>& leaving) {
    auto const members = families_.before(f);
    if (f < first_converted_) {
      Index cell = before_.cell(merged[f]).first_child;
      for (Member& member : members) member = old_element(cell++, leaving);
    } else if (f < first_divided_) {
      members[0] = old_element(changed_.converted[f - first_converted_], leaving);
    } else {
      members[0] = old_element(old_numbers_[divided(f)], leaving);
    }
  }
  /// The cell that a family divides.
  Index divided(std::size_t family) const {
    return family < first_split_ ? changed_.refinement.parents[family - first_divided_]
                                 : changed_.split[family - first_split_];
  }
  /// visit(cell, child) for those of a divided cell's children that are elements of a type.
  template <Element E, class Visit>
  void for_each_child(std::size_t family, Visit const& visit) const {
    auto const& cell = after_.cell(divided(family));
    for (Index child = 0; child < cell.divided().children; ++child)
      if (is_cell_of<E>(after_.cell(cell.first_child + child)))
        visit(cell.first_child + child, child);
  }
  /// How many there are before each divided cell's, and in all.
  template <Element E>
  std::vector<Index> children_of() const {
    std::vector<Index> first(families_.size() - first_divided_ + 1, 0);
    for_each_on_host(static_cast<Index>(first.size()) - 1, few, [&](Index k) {
      for_each_child<E>(first_divided_ + at(k), [&](Index, int) { ++first[at(k) + 1]; });
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    return first;
  }
  /// Elements ascend.
  Leaving leaving_from(std::size_t type) const {
    Leaving all;
    for (auto const& of_part : leaving_) {
      auto const& own = of_part[type];
      all.elements.insert(all.elements.end(), own.elements.begin(), own.elements.end());
      all.cells.insert(all.cells.end(), own.cells.begin(), own.cells.end());
    }
    all.elements = each_once(std::move(all.elements), old_cells_[type].size());
    return all;
  }
  void list_arriving(Index old, int child, std::size_t family) {
    arriving_.push_back({changed_.renumbered(old), child, family, old});
  }
  /// Of the element with a number in the list of its type. Makes it a member of its family.
  Origin origin_of(std::size_t type, int child, std::size_t number, Index element) {
    families_.after(number)[child < 0 ? 0 : at(child)] = {type, element};
    auto const& from = families_.before(number)[0];
    return {from.element, child, static_cast<Index>(number),
            from.type == type ? Index{-1} : static_cast<Index>(from.type)};
  }

  std::vector<CellSet> const& old_cells_;
  Hierarchy<dim> const &before_, &after_;
  ChangedCells<dim> const& changed_;
  std::vector<std::pair<CellKind, CellNodes>> types_;
  ElementFamilies families_;  // merged cells, converted ones, refined ones, split ones
  std::size_t first_converted_ = 0, first_divided_ = 0, first_split_ = 0;  // of the families
  std::vector<std::vector<Leaving>> leaving_;  // by the part of the families and by type
  std::vector<Arriving> arriving_;             // merged and converted cells, ascending
  NumberMap old_numbers_;                      // of cells, where some are divided
};

/// The shares of the elements before in the volume of their family: those of merged ones have several.
template <class M>
void share_volumes(Topology<M> const& before, ElementFamilies& families) {
  for_each_on_host(static_cast<Index>(families.size()), 512, [&](Index f) {
    auto const members = families.before(static_cast<std::size_t>(f));
    auto const shares = families.shares(static_cast<std::size_t>(f));
    if (members.size() == 1) return;
    for (std::size_t i = 0; i < members.size(); ++i)
      visit_member(before, members[i], [&]<Element E>(E, Connectivity<E> const& nodes) {
        shares[i] = volume<E, MassQuadrature<E>>(nodal(before, nodes));
      });
    double const sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share /= sum;
  });
}

/// The values that laws read, of the elements of a type after a change: (elements, values).
template <Element E, class M>
std::vector<double> carried_values(Topology<M> const& before, Topology<M> const& after,
                                   Transfer<M::dim> const& transfer,
                                   ElementValues<M::dim> const& values, std::size_t type) {
  std::size_t const width = values.widths[type];
  auto const& own = before.element_values;
  if (width == 0) return {};
  std::vector<std::vector<double>> lists(own.size());
  lists[type] = own[type];
  for (std::size_t old = 0; old < lists.size(); ++old) {
    if (old == type || !transfer.comes_from(type, old)) continue;
    auto const& places = values.places[type][old];
    if (std::ranges::find(places, -1) != places.end())
      throw Error("change of the mesh: laws read values per element of type ", type,
                  " that elements of type ", old,
                  " have not; give groups of both types the same laws");
    auto const old_width = values.widths[old];
    std::vector<double> taken;
    for (std::size_t first = 0; first < own[old].size(); first += old_width)
      for (int const place : places)
        taken.push_back(own[old][first + static_cast<std::size_t>(place)]);
    lists[old] = std::move(taken);
  }
  auto carried = transfer.carry_elements(lists, type, width);
  if (auto const& set = values.set_by_place[type]) {
    std::size_t e = 0;
    for (auto const& origin : transfer.origins(type)) {
      if (origin.child != Transfer<M::dim>::Origin::same)
        set(mean_of_nodes(after, after.template nodes_of<E>(static_cast<Index>(e))),
            std::span(carried).subspan(e * width, width));
      e += static_cast<std::size_t>(origin.count);
    }
  }
  return carried;
}

}  // namespace detail

}  // namespace pliant

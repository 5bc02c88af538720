#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <pliant/formulation/mass.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/cell_changes.hpp>
#include <pliant/topology/cell_set.hpp>
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
  using Family = typename Transfer<dim>::Family;
  using Member = typename Transfer<dim>::Member;

 public:
  ElementChanges(std::vector<CellSet> const& old_cells, Hierarchy<dim> const& before,
                 std::vector<Index> const& merged, ChangedCells<dim> const& changed)
      : old_cells_(old_cells),
        leaving_cells_(old_cells.size()),
        before_(before),
        after_(*changed.tree),
        changed_(changed) {
    for_each_type_of<M>([&]<Element E>(E, std::size_t) {
      types_.emplace_back(kind_of<typename E::cell>, nodes_on_cell<E>);
    });
    families_.reserve(merged.size() + changed.converted.size() + changed.refinement.parents.size() +
                      changed.split.size());
    for (Index const old : merged) add_merged(old);
    for (Index const old : changed.converted) add_converted(old);
    first_divided_ = families_.size();
    for (Index const c : changed.refinement.parents) add_divided(c);
    for (Index const c : changed.split) add_divided(c);
  }

  /// Those of a type after the change.
  template <Element E>
  ChangedElements<dim> of(std::size_t type) {
    auto const& old_cells = old_cells_[type];
    auto const arriving = arriving_at<E>();
    auto const leaving = leaving_from(type);
    ChangedElements<dim> list;
    list.origins.reserve(leaving.size() + 2 * arriving.size() + 1);
    // Numbers of cells stay in order, and those of new ones follow.
    Index next = 0, count = 0;  // of the old elements, and how many there are so far
    auto const add_those_before = [&](Index end) {
      if (next == end) return;
      list.origins.push_back({.element = next, .child = Origin::same, .count = end - next});
      count += end - next;
      next = end;
    };
    auto left = leaving.begin();
    auto const add_until = [&](Index end) {
      for (; left != leaving.end() && *left < end; ++left) {
        add_those_before(*left);
        next = *left + 1;
      }
      add_those_before(std::max(next, end));
    };
    std::vector<Index> new_cells;
    new_cells.reserve(arriving.size());
    for (auto const& own : arriving) {
      add_until(old_cells.rank(own.old));
      list.origins.push_back(origin_of(type, own.child, own.family, count++));
      new_cells.push_back(own.cell);
    }
    add_until(static_cast<Index>(old_cells.size()));
    list.cells = old_cells.changed(
        leaving_cells_[type], changed_.first_renumbered(),
        [&](Index c) { return changed_.renumbered(c); }, new_cells);
    return list;
  }

  /// Complete once `of` was asked for each type.
  std::vector<Family> families() && { return std::move(families_); }

 private:
  /// A cell that becomes an element: its new number, its family and, as of Origin, its place there.
  struct Arriving {
    Index cell;
    int child;
    std::size_t family;
    Index old = std::numeric_limits<Index>::max();  // number of a cell that was there before
  };

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// The element that a cell was before.
  Member old_element(Index cell) {
    auto const& own = before_.cell(cell);
    auto const type = static_cast<std::size_t>(
        std::ranges::find(types_, std::pair(own.kind, own.has)) - types_.begin());
    leaving_cells_[type].push_back(cell);
    return {type, old_cells_[type].rank(cell)};
  }
  Family& add_family(TreeCell const& whole) {
    auto& family = families_.emplace_back();
    family.mirrored = whole.mirrored;
    return family;
  }
  void add_merged(Index old) {
    auto const& cell = before_.cell(old);
    auto& family = add_family(cell);
    family.pattern = &cell.divided();
    family.before.reserve(at(family.pattern->children));
    for (Index child = 0; child < family.pattern->children; ++child)
      family.before.push_back(old_element(cell.first_child + child));
    family.after.resize(1);
    list_arriving(old, Origin::merged);
  }
  void add_converted(Index old) {
    auto& family = add_family(before_.cell(old));
    family.before = {old_element(old)};
    family.after.resize(1);
    list_arriving(old, Origin::converted);
  }
  void add_divided(Index c) {
    auto const& cell = after_.cell(c);
    auto& family = add_family(cell);
    family.pattern = &cell.divided();
    family.before = {old_element(old_number(c))};
    family.after.resize(at(family.pattern->children));
  }
  /// The old elements of a type that go or are divided, ascending.
  std::vector<Index> leaving_from(std::size_t type) const {
    std::vector<Index> leaving;
    for (auto const& family : families_)
      for (auto const& member : family.before)
        if (member.type == type) leaving.push_back(member.element);
    return each_once(std::move(leaving), old_cells_[type].size());
  }
  void list_arriving(Index old, int child) {
    arriving_.push_back({changed_.renumbered(old), child, families_.size() - 1, old});
  }
  Index old_number(Index c) {
    auto const& renumbered = changed_.coarsening.renumbered.cells;
    if (renumbered.empty()) return c;
    if (old_numbers_.empty())
      for (Index old = 0; old < static_cast<Index>(renumbered.size()); ++old)
        if (renumbered[at(old)] >= 0) old_numbers_.push_back(old);
    return old_numbers_[at(c)];
  }

  /// Ascending: merged and converted cells, and children.
  template <Element E>
  std::vector<Arriving> arriving_at() const {
    std::vector<Arriving> list;
    std::ranges::copy_if(arriving_, std::back_inserter(list),
                         [&](Arriving const& own) { return is_cell_of<E>(after_.cell(own.cell)); });
    std::ranges::sort(list, {}, &Arriving::cell);
    auto family = first_divided_;
    auto const add_children = [&](std::vector<Index> const& parents) {
      for (Index const parent : parents) {
        Index const first = after_.cell(parent).first_child;
        for (Index child = 0; child < after_.cell(parent).divided().children; ++child)
          if (is_cell_of<E>(after_.cell(first + child)))
            list.push_back({first + child, child, family});
        ++family;
      }
    };
    add_children(changed_.refinement.parents);
    add_children(changed_.split);
    return list;
  }
  /// Of the element with a number in the list of its type. Makes it a member of its family.
  Origin origin_of(std::size_t type, int child, std::size_t number, Index element) {
    auto& family = families_[number];
    family.after[child < 0 ? 0 : at(child)] = {type, element};
    auto const& from = family.before[0];
    return {from.element, child, static_cast<Index>(number),
            from.type == type ? Index{-1} : static_cast<Index>(from.type)};
  }

  std::vector<CellSet> const& old_cells_;
  std::vector<std::vector<Index>> leaving_cells_;  // by type, by their old numbers
  Hierarchy<dim> const &before_, &after_;
  ChangedCells<dim> const& changed_;
  std::vector<std::pair<CellKind, CellNodes>> types_;
  std::vector<Family> families_;    // merged cells, converted ones, refined ones, split ones
  std::vector<Arriving> arriving_;  // merged and converted cells
  std::size_t first_divided_ = 0;   // of the families
  std::vector<Index> old_numbers_;  // of cells; empty until one is asked for that changed
};

/// The shares of the elements before in the volume of their family, for those that are merged.
template <class M>
void share_volumes(Topology<M> const& before,
                   std::vector<typename Transfer<M::dim>::Family>& families) {
  for (auto& family : families) family.shares.resize(family.before.size());
  for (auto& family : families)
    for (std::size_t i = 0; i < family.before.size(); ++i)
      visit_member(before, family.before[i], [&]<Element E>(E, Connectivity<E> const& nodes) {
        family.shares[i] = volume<E, MassQuadrature<E>>(nodal(before, nodes));
      });
  for (auto& family : families) {
    double const sum = std::accumulate(family.shares.begin(), family.shares.end(), 0.0);
    for (double& share : family.shares) share /= sum;
  }
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

#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/formulation/mass.hpp>
#include <pliant/topology/cell_changes.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

// What becomes of the elements of a mesh when the cells of its tree change.
namespace pliant {

/// What laws read per element: how many values elements of each type have, and which of an old type's those are that an
/// element takes along into another type: by type and old type, for each value its place; −1 where that has none.
struct ElementValues {
  std::vector<std::size_t> widths;
  std::vector<std::vector<std::vector<int>>> places;
};

namespace detail {

/// The elements of a type after a change.
template <int Dim>
struct ChangedElements {
  std::vector<Index> cells;  // of the tree, ascending
  std::vector<typename Transfer<Dim>::Origin> origins;
};

/// What becomes of the elements of types that are the cells `old_cells` of a tree.
template <int Dim>
class ElementChanges {
  using Origin = typename Transfer<Dim>::Origin;
  using Family = typename Transfer<Dim>::Family;

 public:
  ElementChanges(std::vector<std::vector<Index>> const& old_cells, Hierarchy<Dim> const& before,
                 std::vector<Index> const& merged, ChangedCells<Dim> const& changed)
      : old_cells_(old_cells),
        before_(before),
        after_(*changed.tree),
        merged_(merged),
        changed_(changed),
        divided_(changed.refinement.parents) {
    std::ranges::sort(divided_);
  }

  /// Those of a type after the change. Appends the families that are merged, converted or divided.
  template <Element E>
  ChangedElements<Dim> of(std::size_t type, std::vector<Family>& families) const {
    auto const& old_cells = old_cells_[type];
    auto const arriving = arriving_at<E>(type);
    ChangedElements<Dim> list;
    list.cells.reserve(old_cells.size() + arriving.size());
    list.origins.reserve(old_cells.size() + arriving.size());
    auto const add = [&](Index c, Origin const& origin) {
      list.cells.push_back(c);
      list.origins.push_back(origin);
    };
    auto const add_family = [&](TreeCell const& cell, std::size_t old_type) -> Family& {
      auto& family = families.emplace_back();
      family.type = type;
      family.old_type = old_type;
      family.mirrored = cell.mirrored;
      return family;
    };
    auto next = arriving.begin();
    auto const add_arriving_before = [&](Index c) {
      for (; next != arriving.end() && next->cell < c; ++next) {
        auto const& cell = after_.cell(next->cell);
        auto& family = add_family(cell, next->old_type);
        family.after = {static_cast<Index>(list.cells.size())};
        bool const merged = next->old_type == type;
        Index const first = merged ? before_.cell(next->old_cell).first_child : next->old_cell;
        for (Index k = 0; k < (merged ? cell.pattern().children : 1); ++k)
          family.before.push_back(old_element(next->old_type, first + k));
        add(next->cell, {family.before[0], merged ? Origin::merged : Origin::converted,
                         static_cast<Index>(families.size()) - 1,
                         merged ? Index{-1} : static_cast<Index>(next->old_type)});
      }
    };

    // Numbers of cells stay in order, and those of new ones follow.
    auto next_divided = divided_.begin();
    auto next_converted = changed_.converted.begin();
    std::vector<Index> divided_elements;
    for (std::size_t e = 0; e < old_cells.size(); ++e) {
      Index const c = changed_.renumbered(old_cells[e]);
      if (c < 0) continue;
      while (next_converted != changed_.converted.end() && *next_converted < old_cells[e])
        ++next_converted;
      if (next_converted != changed_.converted.end() && *next_converted == old_cells[e]) continue;
      add_arriving_before(c);
      while (next_divided != divided_.end() && *next_divided < c) ++next_divided;
      if (next_divided == divided_.end() || *next_divided != c)
        add(c, {static_cast<Index>(e), Origin::same});
      else
        divided_elements.push_back(static_cast<Index>(e));
    }
    add_arriving_before(static_cast<Index>(after_.cells().size()));
    std::vector<Index> own_divided;
    std::ranges::copy_if(divided_, std::back_inserter(own_divided),
                         [&](Index c) { return is_cell_of<E>(after_.cell(c)); });
    for (Index const parent : changed_.refinement.parents) {
      auto const& cell = after_.cell(parent);
      if (!is_cell_of<E>(cell)) continue;
      auto const place = std::ranges::lower_bound(own_divided, parent) - own_divided.begin();
      auto& family = add_family(cell, type);
      family.before = {divided_elements[static_cast<std::size_t>(place)]};
      for (int child = 0; child < cell.pattern().children; ++child) {
        family.after.push_back(static_cast<Index>(list.cells.size()));
        add(cell.first_child + child,
            {family.before[0], child, static_cast<Index>(families.size()) - 1});
      }
    }
    return list;
  }

 private:
  /// A cell that becomes an element of a type: by its new and old numbers, and the type that its old elements have.
  struct Arriving {
    Index cell, old_cell;
    std::size_t old_type;
  };
  /// Ascending. Merged cells, and converted ones.
  template <Element E>
  std::vector<Arriving> arriving_at(std::size_t type) const {
    std::vector<Arriving> list;
    auto const add = [&](Index old, std::size_t old_type) {
      if (Index const c = changed_.renumbered(old); is_cell_of<E>(after_.cell(c)))
        list.push_back({c, old, old_type});
    };
    for (Index const parent : merged_) add(parent, type);
    for (Index const old : changed_.converted) {
      std::size_t old_type = 0;
      while (!std::ranges::binary_search(old_cells_[old_type], old)) ++old_type;
      add(old, old_type);
    }
    std::ranges::sort(list, {}, &Arriving::cell);
    return list;
  }
  Index old_element(std::size_t type, Index cell) const {
    auto const& cells = old_cells_[type];
    return static_cast<Index>(std::ranges::lower_bound(cells, cell) - cells.begin());
  }

  std::vector<std::vector<Index>> const& old_cells_;
  Hierarchy<Dim> const &before_, &after_;
  std::vector<Index> const& merged_;  // parents, by their old numbers
  ChangedCells<Dim> const& changed_;
  std::vector<Index> divided_;  // ascending
};

/// The shares of the merged elements in the volume of their family.
template <class M>
void share_volumes(M const& mesh, std::vector<typename Transfer<M::dim>::Family>& families) {
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    for (auto& family : families) {
      if (family.old_type != type) continue;
      double sum = 0;
      for (Index e : family.before) {
        auto const& nodes = mesh.template elements<E>()[static_cast<std::size_t>(e)];
        family.shares.push_back(volume<E, MassQuadrature<E>>(nodal(mesh, nodes)));
        sum += family.shares.back();
      }
      for (double& share : family.shares) share /= sum;
    }
  });
}

/// The values that laws read, of the elements of a type after a change: (elements, values).
template <class M>
std::vector<double> carried_values(Topology<M> const& before, Transfer<M::dim> const& transfer,
                                   ElementValues const& values, std::size_t type) {
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
  return transfer.carry_elements(lists, type, width);
}

}  // namespace detail

}  // namespace pliant

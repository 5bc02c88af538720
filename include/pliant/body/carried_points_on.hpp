#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/body/carried_points.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/tree_on.hpp>

// What quadrature points keep, from one mesh to another in a backend's memory, where it is refined or coarsened.
namespace pliant {

namespace detail {

/// A quadrature point of a child of a family, in one of the groups that the child may be in.
struct PointOfChild {
  Index child, group, point;
};
/// The quadrature points of a group, and where in PointSources those are listed that they take their variables from.
struct PointsOfGroup {
  Index points = 0, size = 0;  // size: numbers that each keeps; 0: they keep nothing
  Index of_children = 0;       // (2: whether the parent is mirrored, children, points)
  Index of_merged = 0;         // (2, points, candidates)
  Index candidates = 0;
};

/// From which points those of refined and merged elements take what they keep, as carried_points has it: a point of a child
/// from the nearest one of its parent; one of a merged element from the nearest one of those children that are in a group of the
/// same law.
template <std::size_t Groups>
struct PointSources {
  std::array<PointsOfGroup, Groups> groups;
  std::vector<Index> of_children;       // points of the parent
  std::vector<PointOfChild> of_merged;  // for each point, the nearest first
};

/// Of the groups of an element table.
template <class Table>
PointSources<std::size_t{Table::groups}> point_sources() {
  using Cell = typename Table::element::cell;
  using Place = Vector<double, Table::element::dim>;
  PointSources<std::size_t{Table::groups}> sources;
  auto const& pattern = pattern_of(kind_of<Cell>, Division::refined);
  std::vector<typename KeptPoints<Table::element::dim>::Group> groups;
  [&]<int... G>(std::integer_sequence<int, G...>) {
    (groups.push_back(points_of<typename Table::template formulation<G>>()), ...);
  }(std::make_integer_sequence<int, Table::groups>());
  auto const size = [](auto const& list) { return static_cast<Index>(list.size()); };
  for (std::size_t g = 0; g < groups.size(); ++g) {
    auto const& own = groups[g];
    auto& to = sources.groups[g];
    if (own.size == 0) continue;
    to = {.points = size(own.places),
          .size = own.size,
          .of_children = size(sources.of_children),
          .of_merged = size(sources.of_merged)};
    for (bool const mirrored : {false, true}) {
      for (int child = 0; child < pattern.children; ++child)
        for (Place const& place : own.places) {
          auto const at = on_parent<Cell>(place, pattern, child, mirrored);
          NearestPlace nearest;
          Index from = 0;
          for (Index p = 0; p < to.points; ++p)
            if (nearest.is_nearer(own.places[static_cast<std::size_t>(p)], at)) from = p;
          sources.of_children.push_back(from);
        }
      for (Place const& at : own.places) {
        std::vector<std::pair<Place, PointOfChild>> candidates;
        for (int child = 0; child < pattern.children; ++child)
          for (std::size_t h = 0; h < groups.size(); ++h) {
            if (groups[h].size == 0 || *groups[h].law != *own.law) continue;
            for (Index p = 0; p < size(groups[h].places); ++p)
              candidates.push_back({on_parent<Cell>(groups[h].places[static_cast<std::size_t>(p)],
                                                    pattern, child, mirrored),
                                    {child, static_cast<Index>(h), p}});
          }
        to.candidates = size(candidates);
        while (!candidates.empty()) {
          NearestPlace nearest;
          auto first = candidates.begin();
          for (auto it = candidates.begin(); it != candidates.end(); ++it)
            if (nearest.is_nearer(it->first, at)) first = it;
          sources.of_merged.push_back(first->second);
          candidates.erase(first);
        }
      }
    }
  }
  return sources;
}

/// The variables of points of elements, (variables, elements), and the groups of these; without tags all are in one.
template <class U>
struct PointsView {
  U* variables;
  Tag const* tags;
  Index count;

  [[nodiscard]] PLIANT_HOST_DEVICE Tag tag(Index e) const { return tags != nullptr ? tags[e] : 0; }
  [[nodiscard]] PLIANT_HOST_DEVICE U& at(Index e, Index k) const {
    return variables[static_cast<std::ptrdiff_t>(count) * k + e];
  }
};

/// Elements that stay keep what their group keeps, and those that a refinement made take from their parents.
template <class T, std::size_t Groups>
struct CarryPoints {
  TreeView tree;
  LeavesView leaves;
  PointsView<T const> before;
  PointsView<T> now;
  std::array<PointsOfGroup, Groups> groups;
  Index const* sources;  // of children; null: none were made

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (leaves.comes_from_others(i)) return;
    Index const place = leaves.from(i), cell = leaves.leaves[i];
    auto const& own = groups[before.tag(place)];
    if (!leaves.is_new(i)) {
      for (Index k = 0; k < own.size * own.points; ++k) now.at(i, k) = before.at(place, k);
      return;
    }
    if (sources == nullptr || own.size == 0) return;
    Index const p = tree.cells[static_cast<std::size_t>(cell)].parent;
    auto const& parent = tree.cells[static_cast<std::size_t>(p)];
    Index const children = parent.divided().children;
    Index const row = (parent.mirrored ? children : 0) + cell - parent.first_child;
    for (Index q = 0; q < own.points; ++q) {
      Index const source = sources[own.of_children + row * own.points + q];
      for (Index k = 0; k < own.size; ++k)
        now.at(i, own.size * q + k) = before.at(place, own.size * source + k);
    }
  }
};
/// Merged elements take from their children.
template <class T, std::size_t Groups>
struct MergePoints {
  TreeView tree;
  LeavesView leaves;
  PointsView<T const> before;
  PointsView<T> now;
  std::array<PointsOfGroup, Groups> groups;
  PointOfChild const* sources;  // of merged elements

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (leaves.children(r) == 0) return;
    Index const place = leaves.merged_place(r), first = leaves.first_child_before(r);
    auto const& own = groups[now.tag(place)];
    bool const mirrored = tree.cells[static_cast<std::size_t>(leaves.families[r].cell)].mirrored;
    for (Index q = 0; q < own.points; ++q) {
      Index const row = (mirrored ? own.points : 0) + q;
      auto const* source = sources + own.of_merged + row * own.candidates;
      while (before.tag(first + source->child) != source->group) ++source;
      for (Index k = 0; k < own.size; ++k)
        now.at(place, own.size * q + k) =
            before.at(first + source->child, own.size * source->point + k);
    }
  }
};

}  // namespace detail

/// Gives the elements of a body's type I what their points keep, after a change of their leaves, of which `tree` is what came out.
/// Those of `next` are zero before. Waits for nothing.
template <std::size_t I, Backend B, class Parts>
void carry_points(B const& backend, TreeView const& tree, LeavesView const& leaves,
                  Parts const& parts, Parts& next) {
  using Table = std::remove_cvref_t<decltype(std::get<I>(parts.layout.tables))>;
  using T = typename B::scalar;
  if constexpr (Table::Laws::internal_variable_count > 0) {
    static auto const sources = detail::point_sources<Table>();
    constexpr std::size_t groups{Table::groups};
    auto const& elements = std::get<I>(parts.state.elements);
    auto& elements_now = std::get<I>(next.state.elements);
    auto const tags = [](auto const& of) { return groups > 1 ? of.tags.data() : nullptr; };
    detail::PointsView<T const> const before{elements.internal_variables.data(), tags(elements),
                                             leaves.count_before};
    detail::PointsView<T> const now{elements_now.internal_variables.data(), tags(elements_now),
                                    leaves.count};
    bool const merges = leaves.merged > 0;
    typename B::template Array<Index> of_children;
    if (!merges) of_children = upload(backend, sources.of_children);
    backend.for_each(leaves.count,
                     detail::CarryPoints<T, groups>{tree, leaves, before, now, sources.groups,
                                                    of_children.data()});
    if (!merges) return;
    auto const of_merged = upload(backend, sources.of_merged);
    backend.for_each(leaves.merged,
                     detail::MergePoints<T, groups>{tree, leaves, before, now, sources.groups,
                                                    of_merged.data()});
  }
}

}  // namespace pliant

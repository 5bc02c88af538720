#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <pliant/backend/dispatch.hpp>
#include <pliant/body/element_table.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/topology/hierarchy.hpp>

// What children take over from the elements that were split.
namespace pliant::detail {

template <Element E>
inline constexpr int sides_of = static_cast<int>(E::cell::sides().size());

/// The leaves of a tree that are elements of a type, in the order of the mesh's list.
template <Element E>
std::vector<Index> leaves_of(Hierarchy const& tree) {
  std::vector<Index> cells;
  for (Index c : tree.leaves())
    if (tree.cell(c).sides == sides_of<E>) cells.push_back(c);
  return cells;
}

inline std::vector<Facet<2>> facets_of(Hierarchy const& tree, int mark) {
  std::vector<Facet<2>> facets;
  for (auto const& facet : tree.facets_of(mark)) facets.push_back({facet.nodes[0], facet.nodes[1]});
  return facets;
}

/// Where a point of a child lies on its parent's cell; the fourth child of a triangle is turned by half a
/// turn.
template <class Cell>
Vector<double, 2> on_parent(Vector<double, 2> const& xi, int child) {
  if (child < Cell::corners) return 0.5 * (Cell::corner(child) + xi);
  Vector<double, 2> const middle{{{0.5}, {0.5}}};
  return middle - 0.5 * xi;
}

/// Appends the internal variables of an element: those of the nearest point of its ancestor.
template <class Table>
void inherit_internal_variables(Table const&, std::vector<double> const& rows, std::size_t ancestor,
                                Tag tag, std::vector<int> const& children,
                                std::vector<double>& internal) {
  constexpr int width = Table::Laws::internal_variable_count;
  if constexpr (width > 0) {
    std::size_t const first = internal.size();
    internal.resize(first + std::size_t{width}, 0.0);
    auto const fill = [&]<int G>(GroupNumber<G>) {
      using F = typename Table::template formulation<G>;
      if constexpr (internal_variables_of<F> > 0) {
        using Cell = typename F::element::cell;
        constexpr auto rule = F::quadrature::template rule<Cell>();
        constexpr int size = internal_variables_of<F> / F::points;
        for (int q = 0; q < F::points; ++q) {
          Vector<double, 2> at{{{rule.points[q][0]}, {rule.points[q][1]}}};
          for (auto child = children.rbegin(); child != children.rend(); ++child)
            at = on_parent<Cell>(at, *child);
          int nearest = 0;
          double least = std::numeric_limits<double>::infinity();
          for (int p = 0; p < F::points; ++p) {
            double const apart = std::hypot(rule.points[p][0] - at[0], rule.points[p][1] - at[1]);
            if (apart < least) {
              least = apart;
              nearest = p;
            }
          }
          for (int k = 0; k < size; ++k)
            internal[first + static_cast<std::size_t>(size * q + k)] =
                rows[std::size_t{width} * ancestor + static_cast<std::size_t>(size * nearest + k)];
        }
      }
    };
    dispatch<Table::groups>(tag, fill);
  }
}

/// The elements of one type after a refinement, in the order of the mesh's list.
template <Element E>
struct InheritedElements {
  std::vector<Connectivity<E>> elements;
  ElementStart start;
  std::vector<double> internal_variables;
};

/// `tags`: the groups of the elements before, by the user's number.
template <class Table>
auto inherited_elements(Table const& table, std::vector<Tag> const& tags, Hierarchy const& before,
                        Hierarchy const& after, std::vector<Index> const& parents) {
  using E = typename Table::element;
  struct Origin {
    std::size_t element;        // by the user's number
    std::vector<int> children;  // from it downwards
  };
  std::map<Index, Origin> origin_of;  // by cell
  auto const old_leaves = leaves_of<E>(before);
  for (std::size_t e = 0; e < old_leaves.size(); ++e) origin_of[old_leaves[e]] = {e, {}};
  for (Index parent : parents)
    if (auto const found = origin_of.find(parent); found != origin_of.end())
      for (int c = 0; c < 4; ++c) {
        Origin origin = found->second;
        origin.children.push_back(c);
        origin_of[after.cell(parent).first_child + c] = std::move(origin);
      }
  auto const old_internal_variables = table.in_user_order(table.internal_variables);
  std::size_t const values = tags.empty() ? 0 : table.value_rows.size() / tags.size();
  InheritedElements<E> now;
  for (Index c : leaves_of<E>(after)) {
    std::copy_n(after.cell(c).nodes.begin(), std::size_t{E::nodes},
                now.elements.emplace_back().begin());
    auto const& [element, children] = origin_of.at(c);
    now.start.tags.push_back(tags[element]);
    for (std::size_t k = 0; k < values; ++k)
      now.start.values.push_back(table.value_rows[values * element + k]);
    inherit_internal_variables(table, old_internal_variables, element, tags[element], children,
                               now.internal_variables);
  }
  return now;
}

/// A condition goes over to the children of its facets; one on nodes stays with these nodes.
inline void inherit_condition(Hierarchy const& tree, int mark, Condition<2>& condition) {
  if (condition.facets.empty()) return;  // perhaps younger than the tree, which has no such mark
  condition.facets = facets_of(tree, mark);
  auto nodes = nodes_of(condition.facets);
  nodes.insert(nodes.end(), condition.nodes.begin(), condition.nodes.end());
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  condition.nodes = std::move(nodes);
}

}  // namespace pliant::detail

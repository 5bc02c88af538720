#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/division_plan.hpp>
#include <pliant/topology/element_nodes.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Divides leaves of a tree as a plan says, on the threads of the host. Refers to both.
class CellDivision {
 public:
  CellDivision(TreeLists& lists, DivisionPlan& plan) : lists_(lists), plan_(plan) {}

  /// Gives the nodes that it makes: of each leaf the points of its pattern, in their order; then those of the children's
  /// elements.
  std::vector<PlacedNode> divide() {
    Index const first_node = lists_.nodes;
    plan_.make_room();
    std::vector<PlacedNode> made(plan_.new_nodes());
    auto division = plan_.view();
    division.first_node = first_node;
    division.made = made.data();
    auto const for_each_part = [&](auto const& count, auto const& make) {
      plan_.for_each([&](Index r) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(count(r)); ++k) make(r, k);
      });
    };
    for_each_part([&](Index r) { return division.pattern_at(r).edges; },
                  [&](Index r, std::size_t e) { division.make_on_edge(r, e); });
    for_each_part([&](Index r) { return division.pattern_at(r).sides; },
                  [&](Index r, std::size_t s) { division.make_on_side(r, s); });
    plan_.for_each([&](Index r) { division.make_inside(r); });
    for_each_part([&](Index r) { return division.parts[r].cells; },
                  [&](Index r, std::size_t i) { division.make_child(r, i); });
    std::vector<Index> quadratic;  // children
    for (Index r = 0; r < plan_.leaves(); ++r) {
      auto const& parent = division.cell(r);
      Index const children = division.parts[r].cells;
      lists_.divided.push_back(division.leaf(r));
      lists_.count_leaves(parent.has, children - 1);
      for (Index k = 0; parent.has != CellNodes::corners && k < children; ++k)
        quadratic.push_back(parent.first_child + k);
    }
    make_element_nodes(lists_, quadratic, true, made);
    return made;
  }

 private:
  TreeLists& lists_;
  DivisionPlan& plan_;
};

}  // namespace pliant::detail

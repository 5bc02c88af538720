#pragma once

#include <memory>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/hierarchy.hpp>

namespace pliant {

/// The cells of a body at one moment, in the user's order. Never changed: a refinement makes another.
template <class M>
struct Topology {
  M mesh;                                         ///< of the elements that act
  Interpolation interpolation;                    ///< its hanging nodes
  std::shared_ptr<Hierarchy<M::dim> const> tree;  ///< null before the first refinement
  std::vector<std::vector<Index>>
      cells;  ///< per type: the cells of the tree that its elements are, ascending
  std::vector<std::vector<double>> element_values;  ///< per type: (elements, values) that laws read

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("mesh", r.mesh...);
    visit("hanging nodes", r.interpolation...);
    visit("refinement tree", r.tree...);
    visit("cells of elements", r.cells...);
    visit("values of elements", r.element_values...);
  }
};

}  // namespace pliant

#pragma once

#include <vector>

#include <pliant/adaptation/change_mesh.hpp>
#include <pliant/adaptation/lists_on.hpp>
#include <pliant/adaptation/rule.hpp>

namespace pliant {

/// What refinement did.
struct RefinementReport {
  std::size_t refined = 0;  // elements split, those included that keep neighbours within one level
  std::size_t new_nodes = 0;
};

/// What coarsening did.
struct CoarseningReport {
  std::size_t merged = 0;  // elements that took the place of their children
  std::size_t gone_nodes = 0;
};

/// What raising degrees did.
struct RaisingReport {
  std::size_t raised = 0;
  std::size_t new_nodes = 0;
};

/// What lowering degrees did.
struct LoweringReport {
  std::size_t lowered = 0;
  std::size_t gone_nodes = 0;
};

/// What splitting did.
struct SplittingReport {
  std::size_t split = 0;
  std::size_t new_nodes = 0;
};

/// What merging did.
struct MergingReport {
  std::size_t merged = 0;  // elements that took the place of those into which they were split
  std::size_t gone_nodes = 0;
};

/// Divides elements of a body: triangles and quadrilaterals into four, tetrahedra, hexahedra and wedges into eight, pyramids
/// into ten (see RefinementPattern). `marked` has, for each element type in the order of the
/// mesh, the elements to split by the user's number: each a list on the host, or ElementsThere in the memory of the body's
/// backend, written by what is done or was queued on its stream, and read before this returns.
/// Neighbours differ by one level at most, across edges and sides;
/// hanging nodes become slaves. New nodes take displacement and velocity from the parent's shape functions,
/// nodes that stay keep theirs and their number; each family then gets back the momentum that
/// lumping its mass anew took, so that linear momentum is kept to rounding and rigid translation
/// exactly. Children inherit groups, conditions on facets, pressures and named boundaries;
/// conditions and loads on nodes stay with their nodes. What it did to the energy is in ledger(body).
/// Elements that were refined max_level times are left alone.
/// Throws Error, with the body as it was, where an element is unknown, max_level is negative or above most_levels, the body's
/// limits would be exceeded, or a user's force term cannot be made anew. Listeners are told last: the body is refined whatever
/// they throw.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
RefinementReport refine(TheBody& body, std::vector<List> const& marked, int max_level = 30) {
  detail::check_lists<typename TheBody::mesh_type>("refine", marked);
  auto const done = detail::change_mesh<TheBody, List>(body, {.refine = marked}, max_level);
  return {done.counts.refined, done.new_nodes};
}

/// Undoes refinement: where all children of an element are marked (as for refine), and none is refined itself,
/// the element takes their place. A family stays where it would differ from a neighbour by two levels, where a node
/// would go that a condition on nodes names, or where of its facets not all are under a condition or pressure that
/// some are under. Nodes that stay keep displacement, velocity and order, and so their number if they are of the
/// initial mesh; nodes that go hand their loads to those they lay between, and each family keeps its momentum. Merged
/// elements are in the group that most of their children were in (the first of equals), have the mean of their values
/// by volume, and the internal variables of the nearest points. Errors as of refine.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
CoarseningReport coarsen(TheBody& body, std::vector<List> const& marked) {
  detail::check_lists<typename TheBody::mesh_type>("coarsen", marked);
  auto const done = detail::change_mesh<TheBody, List>(body, {.coarsen = marked});
  return {done.counts.coarsened, done.gone_nodes};
}

/// Gives linear elements of a body the degree two: they become elements of the mesh's quadratic type on the same cell (Tri3
/// Tri6, Quad4 Quad8 or Quad9, Tet4 Tet10, Hex8 Hex20 or Hex27), which the mesh names, with no elements or some, and of
/// which the body has a Group. `marked` as for refine. Beside elements that stay linear, finer ones included, displacements
/// stay linear: nodes there are slaves, so that a patch gains where all elements around an edge are raised (`ring` = 1
/// raises all around those that are marked). Each goes to the group of the same law, or to the first of its type where
/// none has it; then what quadrature points keep begins at rest. New nodes lie in the middle between corners, with the
/// displacement and velocity there; each element keeps its momentum. Facets get the nodes between their corners.
/// Throws Error, with the body as it was, as refine, for elements that are quadratic, and where the mesh has no
/// quadratic type on their cell.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
RaisingReport raise(TheBody& body, std::vector<List> const& marked, RaiseOptions options = {}) {
  detail::check_lists<typename TheBody::mesh_type>("raise", marked);
  if (options.ring < 0)
    throw Error("raise: a ring of ", options.ring, "; give the number of rings, 0 or more");
  auto const done =
      detail::change_mesh<TheBody, List>(body, {.raise = marked, .raised_rings = options.ring});
  return {done.counts.raised, done.new_nodes};
}

/// Undoes raising, and gives quadratic elements of the initial mesh corners only. Nodes between corners go where no other
/// element has them, and hand their loads to those they lay between; those of the initial mesh stay with their numbers
/// and move with the corners. Elements with nodes that a condition on nodes names stay as they are. Groups, momentum and
/// errors as of raise.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
LoweringReport lower(TheBody& body, std::vector<List> const& marked) {
  detail::check_lists<typename TheBody::mesh_type>("lower", marked);
  auto const done = detail::change_mesh<TheBody, List>(body, {.lower = marked});
  return {done.counts.lowered, done.gone_nodes};
}

/// Puts elements of another shape in the place of linear ones, of which no edge or side is divided: a Quad4 becomes four
/// triangles (Tri3) around a new node in its middle, or two (`triangles` = 2) along its shorter diagonal, a Hex8 six
/// pyramids (Pyramid5) around a new node, and two pyramids that share a base, of which one is marked, two Tet4 each along
/// the shorter diagonal of that; other pyramids stay. The mesh names the types that elements become, with no elements or
/// some, and the body has a Group of each. `marked` as for refine. All can be refined further (pyramids into pyramids
/// and Tet4, which a mesh with pyramids names too).
/// A new node takes the displacement and velocity of the middle; each element keeps its momentum. Groups as of raise.
/// Throws Error, with the body as it was, as refine, for elements of other types, where the mesh has not the type that
/// they become, and for another number of triangles.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
SplittingReport split(TheBody& body, std::vector<List> const& marked, SplitOptions options = {}) {
  detail::check_lists<typename TheBody::mesh_type>("split", marked);
  if (options.triangles != 2 && options.triangles != 4)
    throw Error("split: into ", options.triangles, " triangles; give 2 or 4");
  detail::MarkedLists<List> lists;
  (options.triangles == 2 ? lists.split_in_two : lists.split) = marked;
  auto const done = detail::change_mesh(body, lists);
  return {done.counts.split, done.new_nodes};
}

/// Undoes splitting: where all elements that one was split into are marked, and none is refined itself or of degree two, it
/// takes their place; of two pyramids that share a base both or none. The node in its middle goes, unless a condition on nodes names it; then it stays split. Groups,
/// values of elements, internal variables, momentum and loads as of coarsen. Throws Error as refine, and for elements
/// of types that nothing is split into.
template <DeformableBody TheBody, detail::MarkedList List = std::vector<Index>>
MergingReport merge(TheBody& body, std::vector<List> const& marked) {
  detail::check_lists<typename TheBody::mesh_type>("merge", marked);
  auto const done = detail::change_mesh<TheBody, List>(body, {.merge = marked});
  return {done.counts.merged, done.gone_nodes};
}

/// How often each element of a type was refined, by the user's number.
template <Element E, DeformableBody TheBody>
std::vector<int> refinement_levels(TheBody const& body) {
  return detail::levels_of<E>(body.parts());
}

/// The largest mesh that refinements of a body may make.
template <DeformableBody TheBody>
void set_mesh_limits(TheBody& body, MeshLimits limits) {
  body.parts().limits = limits;
}

}  // namespace pliant

#pragma once

#include <memory>
#include <span>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/adaptation/inheritance.hpp>
#include <pliant/body/ledger.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/topology/hierarchy.hpp>

namespace pliant {

namespace detail {

template <class E>
inline constexpr bool can_be_split = std::same_as<E, Tri3> || std::same_as<E, Quad4>;
template <Element... Es>
inline constexpr bool can_be_split<Mesh<Es...>> = (can_be_split<Es> && ...);

template <class E, Element... Es>
std::vector<Connectivity<E>> elements_or_none(Mesh<Es...> const& mesh) {
  if constexpr ((std::same_as<E, Es> || ...))
    return mesh.template elements<E>();
  else
    return {};
}

/// The refinement tree of a plane body: the one it has, or a new one. Named boundaries and the
/// facets of pressures and of conditions are marked, in this order, so that children inherit them.
/// Conditions come last, for more of them, on nodes, may follow.
template <class TheBody>
std::shared_ptr<Hierarchy const> tree_of(TheBody const& body) {
  if (body.history().tree) return body.history().tree;
  auto const& mesh = body.mesh();
  auto const tree = std::make_shared<Hierarchy>(mesh.nodes, elements_or_none<Tri3>(mesh),
                                                elements_or_none<Quad4>(mesh));
  int mark = 0;
  auto const add = [&](std::vector<Facet<2>> const& facets) {
    std::vector<std::array<Index, 2>> edges;
    for (auto const& facet : facets) edges.push_back({facet[0], facet[1]});
    tree->add_boundary(mark++, edges);
  };
  for (auto const& [name, facets] : mesh.boundaries) add(facets);
  for (auto const& pressure : body.pressures()) add(pressure.facets);
  for (auto const& condition : body.conditions()) add(condition.facets);
  return tree;
}

/// How often each element of a type was refined, by the user's number.
template <Element E, class TheBody>
std::vector<int> levels_of(TheBody const& body) {
  if (!body.history().tree) return std::vector<int>(body.mesh().template elements<E>().size(), 0);
  std::vector<int> levels;
  for (Index c : leaves_of<E>(*body.history().tree))
    levels.push_back(body.history().tree->cell(c).level);
  return levels;
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <class TheBody>
std::vector<Index> cells_of(TheBody const& body, Hierarchy const& tree,
                            std::vector<std::vector<Index>> const& marked) {
  std::vector<Index> cells;
  auto list = marked.begin();
  body.for_each_table([&](auto const& table) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const leaves = leaves_of<E>(tree);
    for (Index e : *list++) {
      if (e < 0 || e >= table.count())
        throw Error("refine: there is no ", E::name(), " element ", e, "; they are numbered 0 to ",
                    table.count() - 1);
      cells.push_back(leaves[static_cast<std::size_t>(e)]);
    }
  });
  return cells;
}

/// A field with its values at new nodes: those of the parent's shape functions.
inline std::vector<Point<2>> interpolated(std::vector<Point<2>> field,
                                          std::vector<NewNode> const& new_nodes) {
  for (NewNode const& n : new_nodes) {
    Point<2> value{};
    for (Index parent : std::span(n.parents).first(static_cast<std::size_t>(n.count)))
      for (std::size_t k = 0; k < 2; ++k)
        value[k] += field[static_cast<std::size_t>(parent)][k] / n.count;
    field.push_back(value);
  }
  return field;
}

}  // namespace detail

/// What a refinement did.
struct RefinementReport {
  std::size_t refined = 0;  // elements split, those included that keep neighbours within one level
  std::size_t new_nodes = 0;
};

/// Splits elements of a plane body into four. `marked` has, for each element type in the order of the
/// mesh, the elements to split by the user's number. Neighbours differ by one level at most; hanging
/// nodes become slaves. New nodes take displacement and velocity from the parent's shape functions,
/// nodes that stay keep theirs and their number; each family then gets back the momentum that
/// lumping its mass anew took, so that linear momentum is kept to rounding and rigid translation
/// exactly. Children inherit groups, conditions on facets, pressures and named boundaries;
/// conditions and loads on nodes stay with their nodes. What it did to the energy is in ledger(body).
/// Throws Error, with the body as it was, where an element is unknown or the capacity would be
/// exceeded.
template <class TheBody>
RefinementReport refine(TheBody& body, std::vector<std::vector<Index>> const& marked,
                        int max_level = 30) {
  static_assert(detail::can_be_split<typename TheBody::mesh_type>,
                "refinement is available for plane meshes of Tri3 and Quad4");
  constexpr std::size_t types = std::tuple_size_v<decltype(TheBody::mesh_type::tables)>;
  if (marked.size() != types)
    throw Error("refine: got lists of marked elements for ", marked.size(),
                " element types, but the mesh has ", types,
                "; give one list per type, empty where none is refined");
  if (std::ranges::all_of(marked, &std::vector<Index>::empty)) return {};

  auto const before = detail::tree_of(body);
  auto const after = std::make_shared<Hierarchy>(*before);
  auto const& capacity = body.history().capacity;
  Refinement const done = after->refine(detail::cells_of(body, *before, marked),
                                        {capacity.nodes, capacity.elements, max_level});
  if (done.parents.empty()) return {};

  auto u = body.displacements(), v = body.velocities();
  detail::check_field("refine (displacements)", u, body.nodes());
  detail::check_field("refine (velocities)", v, body.nodes());
  double const strain_before = body.strain_energy(), kinetic_before = body.kinetic_energy();
  u = detail::interpolated(std::move(u), done.new_nodes);
  v = detail::interpolated(std::move(v), done.new_nodes);

  auto mesh = body.mesh();
  mesh.nodes = after->points();
  std::vector<ElementStart> starts;
  std::vector<std::vector<double>> internal_variables;
  body.for_each_table([&](auto const& table) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto children = detail::inherited_elements(table, body.template groups_of<E>(), *before, *after,
                                               done.parents);
    mesh.template elements<E>() = std::move(children.elements);
    starts.push_back(std::move(children.start));
    internal_variables.push_back(std::move(children.internal_variables));
  });
  int mark = 0;  // as tree_of gave them
  for (auto& [name, facets] : mesh.boundaries) facets = detail::facets_of(*after, mark++);
  auto pressures = body.pressures();
  for (auto& pressure : pressures) pressure.facets = detail::facets_of(*after, mark++);
  auto conditions = body.conditions();
  for (auto& condition : conditions) detail::inherit_condition(*after, mark++, condition);
  auto loads = body.loads();
  if (!loads.empty()) loads.resize(mesh.nodes.size(), Point<2>{});

  auto layout = body.make_layout(std::move(mesh), after->slaves(), starts);
  Point<2> const taken = detail::give_momentum_back(*after, done.parents, body.material().density,
                                                    layout, conditions, v);

  // As they are, and not by the body's setters, which stop driven nodes.
  using T = typename TheBody::scalar;
  layout.u.upload(layout.padded(u));
  layout.v.upload(layout.padded(v));
  auto internal = internal_variables.begin();
  std::apply(
      [&](auto&... table) {
        (table.internal_variables.upload(table.in_internal_order(*internal++)), ...);
      },
      layout.tables);
  layout.slaves.interpolate(body.backend(), NodeField<T, 2>{layout.u.data()});
  layout.slaves.interpolate(body.backend(), NodeField<T, 2>{layout.v.data()});
  body.replace(std::move(layout), std::move(conditions), std::move(pressures), std::move(loads),
               after, detail::closed_totals(body));
  body.add_refinement({body.time(), "refine", static_cast<double>(done.parents.size()),
                       body.strain_energy() - strain_before, body.kinetic_energy() - kinetic_before,
                       taken});
  return {done.parents.size(), done.new_nodes.size()};
}

}  // namespace pliant

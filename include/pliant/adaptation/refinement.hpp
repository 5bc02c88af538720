#pragma once

#include <map>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/adaptation/inheritance.hpp>
#include <pliant/body/ledger.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/mesh/hierarchy.hpp>

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
Hierarchy tree_of(TheBody const& body) {
  if (body.history().tree) return *body.history().tree;
  auto const& mesh = body.mesh();
  Hierarchy tree(mesh.nodes, elements_or_none<Tri3>(mesh), elements_or_none<Quad4>(mesh));
  int mark = 0;
  auto const add = [&](std::vector<Facet<2>> const& facets) {
    std::vector<std::array<Index, 2>> edges;
    for (auto const& facet : facets) edges.push_back({facet[0], facet[1]});
    tree.add_boundary(mark++, edges);
  };
  for (auto const& [name, facets] : mesh.boundaries) add(facets);
  for (auto const& pressure : body.pressures()) add(pressure.facets);
  for (auto const& condition : body.conditions()) add(condition.facets);
  return tree;
}

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

/// How often each element of a type was refined, by the user's number.
template <Element E, class TheBody>
std::vector<int> levels_of(TheBody const& body) {
  if (!body.history().tree) return std::vector<int>(body.mesh().template elements<E>().size(), 0);
  std::vector<int> levels;
  for (Index c : leaves_of<E>(*body.history().tree))
    levels.push_back(body.history().tree->cell(c).level);
  return levels;
}

inline std::vector<Facet<2>> facets_of(Hierarchy const& tree, int mark) {
  std::vector<Facet<2>> facets;
  for (auto const& facet : tree.facets_of(mark)) facets.push_back({facet.nodes[0], facet.nodes[1]});
  return facets;
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
/// exactly. Children inherit groups, conditions on facets, pressures and named boundaries; conditions
/// and loads on nodes stay with their nodes. What it did to the energy is in ledger(body). Throws
/// Error, with the body as it was, where an element is unknown or the capacity would be exceeded.
template <class TheBody>
RefinementReport refine(TheBody& body, std::vector<std::vector<Index>> const& marked,
                        int max_level = 30) {
  static_assert(detail::can_be_split<typename TheBody::mesh_type>,
                "refinement is available for plane meshes of Tri3 and Quad4");
  std::size_t types = 0;
  body.for_each_table([&](auto const&) { ++types; });
  if (marked.size() != types)
    throw Error("refine: got lists of marked elements for " + std::to_string(marked.size()) +
                " element types, but the mesh has " + std::to_string(types) +
                "; give one list per type, empty where none is refined");
  if (std::ranges::all_of(marked, &std::vector<Index>::empty)) return {};
  Hierarchy const before = detail::tree_of(body);
  auto after = std::make_shared<Hierarchy>(before);

  std::vector<Index> cells;
  std::size_t which = 0;
  body.for_each_table([&](auto const& table) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const leaves = detail::leaves_of<E>(before);
    for (Index e : marked[which]) {
      if (e < 0 || e >= table.count())
        throw Error("refine: there is no " + std::string(E::name()) + " element " +
                    std::to_string(e) + "; they are numbered 0 to " +
                    std::to_string(table.count() - 1));
      cells.push_back(leaves[static_cast<std::size_t>(e)]);
    }
    ++which;
  });
  auto const& capacity = body.history().capacity;
  RefinementLimits const limits{capacity.nodes, capacity.elements, max_level};
  Refinement const done = after->refine(cells, limits);
  if (done.parents.empty()) return {};

  // State on the new nodes.
  auto u = body.displacements(), v = body.velocities();
  detail::check_field("refine (displacements)", u, body.nodes());
  detail::check_field("refine (velocities)", v, body.nodes());
  double const strain_before = body.strain_energy(), kinetic_before = body.kinetic_energy();
  for (NewNode const& n : done.new_nodes) {
    Point<2> at{}, speed{};
    for (int p = 0; p < n.count; ++p)
      for (std::size_t k = 0; k < 2; ++k) {
        auto const parent = static_cast<std::size_t>(n.parents[static_cast<std::size_t>(p)]);
        at[k] += u[parent][k] / n.count;
        speed[k] += v[parent][k] / n.count;
      }
    u.push_back(at);
    v.push_back(speed);
  }

  // The new mesh, with the groups that its elements inherit.
  auto mesh = body.mesh();
  mesh.nodes = after->points();
  std::vector<ElementStart> inherited;
  std::vector<std::vector<double>> histories;
  body.for_each_table([&](auto const& table) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    struct Origin {
      std::size_t element;        // by the user's number
      std::vector<int> children;  // from it downwards
    };
    std::map<Index, Origin> origin_of;  // by cell
    auto const old_leaves = detail::leaves_of<E>(before);
    auto const old_tags = body.template groups_of<E>();
    for (std::size_t e = 0; e < old_leaves.size(); ++e) origin_of[old_leaves[e]] = {e, {}};
    for (Index parent : done.parents)
      if (auto const found = origin_of.find(parent); found != origin_of.end())
        for (int c = 0; c < 4; ++c) {
          Origin origin = found->second;
          origin.children.push_back(c);
          origin_of[after->cell(parent).first_child + c] = std::move(origin);
        }
    auto const old_history = table.in_user_order(table.history);
    std::size_t const values = old_tags.empty() ? 0 : table.value_rows.size() / old_tags.size();
    auto& history = histories.emplace_back();
    auto& elements = mesh.template elements<E>();
    elements.clear();
    inherited.emplace_back();
    for (Index c : detail::leaves_of<E>(*after)) {
      Connectivity<E> nodes;
      std::copy_n(after->cell(c).nodes.begin(), nodes.size(), nodes.begin());
      elements.push_back(nodes);
      Origin const& origin = origin_of.at(c);
      ElementStart& start = inherited.back();
      start.tags.push_back(old_tags[origin.element]);
      for (std::size_t k = 0; k < values; ++k)
        start.values.push_back(table.value_rows[values * origin.element + k]);
      detail::inherit_history(table, old_history, origin.element, old_tags[origin.element],
                              origin.children, history);
    }
  });
  int mark = 0;
  for (auto& [name, facets] : mesh.boundaries) facets = detail::facets_of(*after, mark++);
  auto pressures = body.pressures();
  for (auto& pressure : pressures) pressure.facets = detail::facets_of(*after, mark++);
  auto conditions = body.conditions();
  for (auto& condition : conditions) {
    int const own = mark++;
    if (condition.facets.empty()) continue;  // of nodes, perhaps younger than the tree
    condition.facets = detail::facets_of(*after, own);
    auto nodes = nodes_of(condition.facets);
    nodes.insert(nodes.end(), condition.nodes.begin(), condition.nodes.end());
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    condition.nodes = std::move(nodes);
  }
  auto loads = body.loads();
  if (!loads.empty()) loads.resize(mesh.nodes.size(), Point<2>{});

  // Momentum: slaves hand their impulse to their masters, held directions keep it from moving.
  auto layout = body.make_layout(std::move(mesh), after->slaves(), inherited);
  std::vector<Point<2>> impulse(v.size(), Point<2>{});
  for (Index parent : done.parents)
    detail::add_family_impulse(*after, parent, body.material().density, v, impulse);
  for (Slave const& slave : layout.slave_list) {
    Point<2> const own = std::exchange(impulse[static_cast<std::size_t>(slave.node)], Point<2>{});
    for (auto const& [master, weight] : slave.masters)
      for (std::size_t k = 0; k < 2; ++k)
        impulse[static_cast<std::size_t>(master)][k] += weight * own[k];
  }
  std::vector<DirectionMask> held(v.size(), 0);
  for (auto const& condition : conditions)
    for (Index node : condition.nodes) held[static_cast<std::size_t>(node)] |= condition.directions;
  Point<2> taken{};
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      if (held[i] >> k & 1)
        taken[k] += impulse[i][k];
      else if (layout.mass_list[i] > 0)
        v[i][k] += impulse[i][k] / layout.mass_list[i];

  // As they are, and not by the body's setters, which stop driven nodes.
  using T = typename TheBody::scalar;
  layout.u.upload(layout.padded(u));
  layout.v.upload(layout.padded(v));
  std::size_t type = 0;
  std::apply(
      [&](auto&... table) {
        (table.history.upload(table.in_internal_order(histories[type++])), ...);
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

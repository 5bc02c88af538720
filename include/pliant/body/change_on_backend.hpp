#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <thread>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/body/brought_over.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/body/converted_elements_on.hpp>
#include <pliant/body/topology_on.hpp>
#include <pliant/topology/plan.hpp>
#include <pliant/topology/refinable.hpp>

// Which bodies are refined and coarsened in their backend's memory, and what the host knows of their meshes, which follows when
// it is asked for.
namespace pliant {

namespace detail {

/// Whether meshes of a backend are changed in its memory: where it says so by `keeps_trees`.
template <class B>
inline constexpr bool keeps_trees = false;
template <class B>
  requires requires { requires B::keeps_trees; }
inline constexpr bool keeps_trees<B> = true;

/// Whether the elements of a mesh are of the catalogue.
template <class M>
inline constexpr bool are_refinable = false;
template <Element... Es>
inline constexpr bool are_refinable<Mesh<Es...>> = (Refinable<Es> && ...);

/// Whether the points of elements that others are split into, or these, keep nothing, and the laws of either read what those of the other
/// do.
template <class Parts>
inline constexpr bool shapes_go_along = []<class... Tables>(std::tuple<Tables...>*) {
  auto const from = []<class From>(std::type_identity<From>) {
    auto const to = []<class To>(std::type_identity<To>) {
      if constexpr (differ_in_shape<typename From::element, typename To::element>)
        return From::Laws::internal_variable_count == 0 && values_go_along<From, To>;
      else
        return true;
    };
    return (to(std::type_identity<Tables>{}) && ...);
  };
  return (from(std::type_identity<Tables>{}) && ...);
}(static_cast<decltype(Parts::layout_type::tables)*>(nullptr));
/// Whether bodies of a kind may change their mesh in their backend's memory: with pyramids, of which tetrahedra are among the children,
/// where these go along.
template <class Parts>
inline constexpr bool changes_on_backend =
    keeps_trees<typename Parts::backend_type> && are_refinable<typename Parts::mesh_type> &&
    (!has_type<Pyramid5, typename Parts::mesh_type> ||
     (can_be_refined<typename Parts::mesh_type> && shapes_go_along<Parts>));
/// Whether types of elements that differ in degree alone come in pairs.
template <class M>
inline constexpr bool degrees_are_paired = false;
template <Element... Es>
inline constexpr bool degrees_are_paired<Mesh<Es...>> = []<Element... Others>(Mesh<Others...>*) {
  // No more than two are on cells of one kind.
  auto const on_its_cell = []<Element E>(E) {
    return (0 + ... + (std::same_as<typename E::cell, typename Others::cell> ? 1 : 0));
  };
  return ((on_its_cell(Es{}) <= 2) && ...);
}(static_cast<Mesh<Es...>*>(nullptr));
/// Whether bodies of a kind may change the degree of elements in their backend's memory: where groups of both degrees have the same
/// laws, so that points and elements take along what these keep and read.
template <class Parts>
inline constexpr bool converts_on_backend =
    changes_on_backend<Parts> && degrees_are_paired<typename Parts::mesh_type> &&
    []<class... Tables>(std::tuple<Tables...>*) {
      auto const from = []<class From>(std::type_identity<From>) {
        auto const to = []<class To>(std::type_identity<To>) {
          if constexpr (differ_in_degree<typename From::element, typename To::element>)
            return points_go_along<From, To> && values_go_along<From, To>;
          else
            return true;
        };
        return (to(std::type_identity<Tables>{}) && ...);
      };
      return (from(std::type_identity<Tables>{}) && ...);
    }(static_cast<decltype(Parts::layout_type::tables)*>(nullptr));
/// Whether bodies of a kind may change the shape of elements in their backend's memory: of those that others can be split into, or these.
template <class Parts>
inline constexpr bool splits_on_backend = changes_on_backend<Parts> && shapes_go_along<Parts> &&
                                          has_other_shapes<typename Parts::mesh_type>;
/// The nodes of elements that are raised, by the kind of cell.
template <class M>
NodesOfKinds nodes_when_raised() {
  NodesOfKinds to;
  for_each_type_of<M>([&]<Element E>(E, std::size_t) {
    constexpr std::size_t type = converted_type<E, M>;
    if constexpr (E::degree == 1 && type != no_type)
      to.by_kind[static_cast<std::size_t>(kind_of<typename E::cell>)] =
          nodes_on_cell<typename ElementOfType<M, type>::type>;
  });
  return to;
}
/// Whether nothing of a body has to be made from lists of the host when its mesh changes.
template <class Parts>
bool can_change_on_backend(Parts const& parts) {
  return parts.first->interpolation.empty() && !sets_values_by_place(parts);
}

/// The user's numbers of elements on some cells, by the type.
template <class M>
std::vector<std::vector<Index>> numbers_by_type(Topology<M> const& of,
                                                std::vector<Index> const& cells) {
  auto const counts = of.counts();
  std::vector<std::vector<Index>> numbers(counts.size());
  for (Index cell : cells) {
    std::size_t type = 0;
    if (of.tree) {
      while (!of.cells[type].contains(cell)) ++type;
      cell = of.cells[type].rank(cell);
    } else {  // those of a first mesh follow each other
      for (; cell >= static_cast<Index>(counts[type]); ++type)
        cell -= static_cast<Index>(counts[type]);
    }
    numbers[type].push_back(cell);
  }
  return numbers;
}
/// What was done to cells in a backend's memory; `coarsen`, `merge`: their children took part in it.
enum class ChangeOfCells { refine, coarsen, raise, lower, split, merge };
/// Of a topology, with the same done to some of its cells; those that are split in two, or pairs of pyramids, are ~cell.
template <class M>
TopologyPlan<M> plan_on_host(std::shared_ptr<Topology<M> const> const& before,
                             std::vector<Index> numbers, ChangeOfCells change,
                             ElementValues<M::dim> const& values) {
  HostThreads const threads(*before);
  if (change == ChangeOfCells::coarsen || change == ChangeOfCells::merge) {
    std::vector<Index> children;
    for (Index const c : numbers) {
      auto const& parent = before->tree->cell(c);
      for (Index k = 0; k < parent.divided().children; ++k)
        children.push_back(parent.first_child + k);
    }
    numbers = std::move(children);
  }
  MarkedElements marked;
  if (change == ChangeOfCells::split) {
    std::vector<Index> in_two;
    for (Index const c : numbers)
      if (c < 0) in_two.push_back(~c);
    std::erase_if(numbers, [](Index c) { return c < 0; });
    marked.split_in_two = numbers_by_type(*before, in_two);
  }
  std::array const lists{&marked.refine, &marked.coarsen, &marked.raise,
                         &marked.lower,  &marked.split,   &marked.merge};
  *lists[static_cast<std::size_t>(change)] = numbers_by_type(*before, numbers);
  return *plan_change(before, marked, {}, {}, values);
}
/// What the host knows of a mesh behind a change that was planned there.
template <int Dim, class M>
MeshOnHost<M> mesh_behind(TopologyPlan<M> const& plan, Prescribed<Dim> const& before) {
  return {plan.after, std::make_shared<Prescribed<Dim> const>(carried(before, plan.transfer))};
}
/// The same when it is asked for, of cells in the backend's memory; or brought over from there, where that takes less time and `on`
/// is still at the version behind the change. The latter in the thread that made the change alone: it is that which works with the
/// backend.
template <class Parts, class On, class Cells>
auto changed_when_asked(Parts const& parts, std::shared_ptr<On> const& on,
                        std::shared_ptr<Cells> cells, ChangeOfCells change) {
  using M = typename Parts::mesh_type;
  constexpr bool has_values = []<class... Tables>(std::tuple<Tables...>*) {
    return ((Tables::Laws::value_count > 0) || ...);
  }(static_cast<decltype(Parts::layout_type::tables)*>(nullptr));
  return WhenAsked<MeshOnHost<M>>::by(
      [before = parts.state.topology, prescribed = parts.state.prescribed, cells = std::move(cells),
       change, values = element_values_of(parts), of = std::weak_ptr<On>(on),
       version = on->on_host.version + 1, thread = std::this_thread::get_id()]() {
        auto const own = std::this_thread::get_id() == thread ? of.lock() : nullptr;
        bool const is_now = own && !own->on_host.is_changing && own->on_host.version == version;
        std::optional<MeshOnHost<M>> mesh;
        // Values of elements the host has in double precision.
        if constexpr (!has_values)
          if (is_now && own->is_far_ahead()) mesh = brought_over(*own);
        if (!mesh)
          mesh = mesh_behind(plan_on_host(before.shared(), download<Index>(*cells), change, values),
                             *prescribed);
        if (is_now) own->set_on_host(*mesh);
        return std::make_shared<MeshOnHost<M> const>(std::move(*mesh));
      });
}

/// Values by the row, by the user's number of a node.
template <class U>
std::vector<U> by_user(NodeRows const& rows, std::vector<U> const& by_row) {
  std::vector<U> values(rows.of_node.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = by_row[static_cast<std::size_t>(rows.of_node[i])];
  return values;
}

}  // namespace detail

}  // namespace pliant

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/is_marked.hpp>
#include <pliant/body/change_on_backend.hpp>

// What rules know of the elements of a table by their internal numbers, in the backend's memory: where the mesh is changed
// there, the host is not asked.
namespace pliant::detail {

/// The place of a table's type among the mesh's.
template <class Parts, class Table>
inline constexpr std::size_t type_of =
    Parts::layout_type::template type_of<typename Table::element>;

struct LevelOfLeaf {
  TreeView tree;
  Index const* leaves;
  int* levels;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    levels[i] = tree.cells[static_cast<std::size_t>(leaves[i])].level;
  }
};

/// The user's numbers.
template <class Parts, class Table>
auto numbers_on_backend(Parts const& parts, Table const& table) {
  if constexpr (changes_on_backend<Parts>)
    if (auto const& on = parts.topology_on) {
      auto numbers = unset<Index>(parts.backend, static_cast<std::size_t>(table.count()));
      parts.backend.for_each(table.count(), PutNumbers{on->element_numbers(type_of<Parts, Table>),
                                                       nullptr, numbers.data()});
      return numbers;
    }
  return upload(parts.backend, table.user_elements());
}
/// How often each element of a type was refined, by the user's number.
template <Element E, class Parts>
std::vector<int> levels_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  if (!topology.tree) return std::vector<int>(topology.mesh().template elements<E>().size(), 0);
  std::vector<int> levels;
  for (Index c : topology.cells[Parts::layout_type::template type_of<E>])
    levels.push_back(topology.tree->cell(c).level);
  return levels;
}
/// The same by the internal number, in the backend's memory.
template <class Parts, class Table>
auto levels_on_backend(Parts const& parts, Table const& table) {
  if constexpr (changes_on_backend<Parts>)
    if (auto const& on = parts.topology_on) {
      auto levels = zeros<int>(parts.backend, static_cast<std::size_t>(table.count()));
      parts.backend.for_each(
          table.count(),
          LevelOfLeaf{on->tree.view(), on->leaves(type_of<Parts, Table>).leaves, levels.data()});
      return levels;
    }
  auto const levels = levels_of<typename Table::element>(parts);
  std::vector<int> internal;
  for (Index element : table.user_elements())
    internal.push_back(levels[static_cast<std::size_t>(element)]);
  return upload(parts.backend, internal);
}

/// The user's numbers of elements take the place of their internal ones, where these are known in the backend's memory. Whether
/// they are.
template <class Parts, class Table, class Numbers>
bool put_numbers(Parts const& parts, Table const& table, Numbers& numbers, Index count) {
  if constexpr (changes_on_backend<Parts>)
    if (auto const& on = parts.topology_on) {
      parts.backend.for_each(count, PutNumbers{on->element_numbers(type_of<Parts, Table>),
                                               numbers.data(), numbers.data()});
      return true;
    }
  (void)table;
  return false;
}

/// Calls visit(the user's number, mask) for the elements of which the mask is not zero, in internal order. `masks`: by the
/// internal number, in the backend's memory.
template <class Parts, class Table, class Visit>
void visit_marked(Parts const& parts, Table const& table, std::uint32_t const* masks,
                  Visit const& visit) {
  auto const& backend = parts.backend;
  auto places = backend.select(table.count(), IsMarked<std::uint32_t>{masks});
  if (places.empty()) return;
  auto const count = static_cast<Index>(places.size());
  auto list = upload(backend, places);
  auto some = zeros<std::uint32_t>(backend, places.size());
  backend.for_each(count, TakeListed<std::uint32_t>{masks, list.data(), some.data()});
  auto const own = download<std::uint32_t>(some);
  if (put_numbers(parts, table, list, count))
    list.download(places);
  else
    for (Index& place : places) place = table.user_element(place);
  for (std::size_t k = 0; k < places.size(); ++k) visit(places[k], own[k]);
}

}  // namespace pliant::detail

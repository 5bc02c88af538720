#pragma once

#include <cstddef>
#include <optional>
#include <type_traits>

#include <pliant/adaptation/changes_on_backend.hpp>
#include <pliant/adaptation/mesh_marks.hpp>

namespace pliant::detail {

/// Changes a body's mesh in its backend's memory, where that can be; else nothing. `find_marked`: gives a MarkedThere. Errors as
/// of refine.
template <class Parts, class FindMarked>
auto change_on_backend_by(Parts& parts, int max_level, FindMarked const& find_marked)
    -> std::optional<ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>> {
  using Done = ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>;
  if constexpr (changes_on_backend<Parts>) {
    if (!can_change_on_backend(parts) || parts.host_changes.take_next()) return std::nullopt;
    auto const marked = find_marked();
    if (marked.kinds() == 0) return Done{};
    return ChangesOnBackend<Parts>(parts, max_level)(marked);
  } else {
    return std::nullopt;
  }
}
template <class Parts, class List>
auto change_on_backend_of(Parts& parts, MarkedLists<List> const& marked, int max_level) {
  return change_on_backend_by(parts, max_level, [&] {
    using M = typename Parts::mesh_type;
    check_conversion<M>("raise", 1, marked.raise);
    check_conversion<M>("lower", 2, marked.lower);
    check_splits<M>(marked.split);
    check_splits<M>(marked.split_in_two);
    check_merges<M>(marked.merge);
    return MarkedThere<typename Parts::backend_type>::of(marked);
  });
}
/// Of marked elements.
template <class Parts>
auto change_on_backend(Parts& parts, MarkedLists<> const& marked, int max_level) {
  return change_on_backend_of(parts, marked, max_level);
}
template <class Parts>
auto change_on_backend(Parts& parts, MarkedLists<ElementsThere> const& marked, int max_level) {
  return change_on_backend_of(parts, marked, max_level);
}
/// Of those that rules mark.
template <class Parts>
auto change_on_backend(Parts& parts, MeshMarks const& marks)
    -> std::optional<ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>> {
  return change_on_backend_by(parts, marks.max_level,
                              [&] { return marked_there(std::as_const(parts), marks); });
}

}  // namespace pliant::detail

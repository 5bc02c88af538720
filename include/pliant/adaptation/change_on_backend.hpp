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
    if (marked.none()) return Done{};
    return ChangesOnBackend<Parts>(parts, max_level)(marked);
  } else {
    return std::nullopt;
  }
}
/// Of elements that are marked to be refined, merged, raised or lowered.
template <class Parts>
auto change_on_backend(Parts& parts, MarkedElements const& marked, int max_level) {
  return change_on_backend_by(parts, max_level, [&] {
    check_conversion<typename Parts::mesh_type>("raise", 1, marked.raise);
    check_conversion<typename Parts::mesh_type>("lower", 2, marked.lower);
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      auto const check = [&](char const* verb, auto const& lists) {
        if (type < lists.size())
          check_numbers<E>(verb, lists[type], static_cast<std::size_t>(table.count()));
      };
      check("refine", marked.refine);
      check("coarsen", marked.coarsen);
      check("raise", marked.raise);
      check("lower", marked.lower);
      ++type;
    });
    using Marked = MarkedThere<typename Parts::backend_type>;
    auto const there = [&](auto const& lists) { return Marked::of(parts.backend, lists); };
    return Marked{there(marked.refine), there(marked.coarsen), there(marked.raise),
                  there(marked.lower), marked.raised_rings};
  });
}
/// Of those that are marked, where that is all.
template <class Parts>
auto change_on_backend(Parts& parts, MeshMarks const& marks)
    -> std::optional<ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>> {
  if (!marks.keep_shapes()) return std::nullopt;
  return change_on_backend_by(parts, marks.max_level,
                              [&] { return marked_there(std::as_const(parts), marks); });
}

}  // namespace pliant::detail

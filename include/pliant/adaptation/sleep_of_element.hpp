#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/patch_ranges.hpp>

namespace pliant::detail {

/// Which elements of a table sleep, by their internal numbers.
struct SleepOfElement {
  std::uint8_t const* asleep = nullptr;  // (patches), in the backend's memory; null: none sleeps
  PatchRanges patches{};

  template <class Parts, class Table>
  static SleepOfElement of(Parts const& parts, Table const& table) {
    constexpr std::size_t type = Parts::layout_type::template type_of<typename Table::element>;
    return {
        parts.awake ? parts.awake->asleep.data() + parts.patch_nodes->first_of_type[type] : nullptr,
        table.elements.patches()};
  }
  PLIANT_HOST_DEVICE bool sleeps(Index e) const {
    return asleep != nullptr && asleep[patches.patch_of(e)] != 0;
  }
};

}  // namespace pliant::detail

#pragma once

#include <cstddef>
#include <type_traits>

#include <pliant/config.hpp>

namespace pliant {

/// A block of the entries of a list, without values at first.
template <class V>
struct Page {
  static constexpr std::size_t entries = 256;
  static_assert(std::is_trivially_copyable_v<V>);
  union {
    V values[entries];
  };
  Page() {}
};

/// A list as loops see it: its pages. Which of them may be written is for the owner of the list to say.
template <class V>
struct Pages {
  Page<V>* const* table = nullptr;

  PLIANT_HOST_DEVICE V& operator[](std::size_t i) const {
    return table[i / Page<V>::entries]->values[i % Page<V>::entries];
  }
};

}  // namespace pliant

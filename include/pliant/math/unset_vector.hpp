#pragma once

#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace pliant {

namespace detail {

/// An allocator whose entries have no value until they are written, where none is given.
template <class V>
struct UnsetAllocator : std::allocator<V> {
  static_assert(std::is_trivially_copyable_v<V>);
  template <class Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };

  UnsetAllocator() = default;
  template <class Other>
  UnsetAllocator(UnsetAllocator<Other> const&) noexcept {}
  template <class Other>
  void construct(Other* entry) noexcept {
    ::new (static_cast<void*>(entry)) Other;
  }
  template <class Other, class... Values>
  void construct(Other* entry, Values&&... values) {
    ::new (static_cast<void*>(entry)) Other(std::forward<Values>(values)...);
  }
};

}  // namespace detail

/// A vector in which resize(n) writes nothing: the threads that fill it are the first to touch its memory, which takes longer
/// than to write to it again.
template <class V>
using UnsetVector = std::vector<V, detail::UnsetAllocator<V>>;

}  // namespace pliant

#pragma once

#include <type_traits>
#include <utility>

#include <pliant/config.hpp>

namespace pliant {

/// Calls f with 0, 1, ... N − 1 as compile-time constants: a loop that is unrolled for certain, where
/// an index that is only known at run time would send an array from registers to memory.
template <int N, class F>
PLIANT_HOST_DEVICE constexpr void unroll(F const& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) PLIANT_INLINE {
    (f(std::integral_constant<int, I>()), ...);
  }(std::make_integer_sequence<int, N>());
}

/// n, unknown to the compiler: a loop to it is not unrolled.
PLIANT_HOST_DEVICE int unknown(int n) {
  asm("" : "+r"(n));
  return n;
}

}  // namespace pliant

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

/// Calls f with 0, 1, ... N − 1 where the indexed arrays of a device are to stay in registers, and a loop on the host is to
/// stay one: large bodies that are unrolled do not fit the caches of instructions.
template <int N, class F>
PLIANT_HOST_DEVICE void repeat(F const& f) {
#if defined(__CUDA_ARCH__)
#pragma unroll
  for (int i = 0; i < N; ++i) f(i);
#else
  for (int i = 0, n = unknown(N); i < n; ++i) f(i);
#endif
}

}  // namespace pliant

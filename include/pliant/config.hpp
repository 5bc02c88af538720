#pragma once

// A file that is not there ends the compilation: what else an earlier standard lacks is not listed.
#if __cplusplus < 202002L
#error "Pliant needs C++20: compile with -std=c++20."
#include "C++20"
#endif

// Without infinities and NaN no check for finite values ever fails, and sums in another order lose
// small strains (the logarithm of 1 + 1e-12 its fifth digit). nvcc's --use_fast_math does neither: it
// rounds single precision on the device more coarsely and flushes numbers below 1e-38 to zero.
#if !defined(PLIANT_ALLOW_FAST_MATH) && \
    (defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ > 0 || defined(__ASSOCIATIVE_MATH__))
#error \
    "-ffast-math (-Ofast, -ffinite-math-only, -fassociative-math) switches off Pliant's checks for \
finite values: put -fno-finite-math-only -fno-associative-math behind it. -DPLIANT_ALLOW_FAST_MATH \
compiles without these checks."
#endif

#include <cstdint>

/// Stands between the parameters and the body of a lambda in a kernel: out of line it would take packs
/// of elements through memory. Nothing where the compiler does not optimise: that compiles faster.
#if defined(__OPTIMIZE__) || defined(__CUDACC__)
#define PLIANT_INLINE __attribute__((always_inline))
#else
#define PLIANT_INLINE
#endif

/// Marks functions that run on the host and, when compiled as CUDA, on the device too.
#if defined(__CUDACC__)
#define PLIANT_HOST_DEVICE __host__ __device__ __forceinline__
#else
#define PLIANT_HOST_DEVICE inline PLIANT_INLINE
#endif

/// Marks functions that few elements call. On a CPU they stay out of line, where they take no registers from what
/// surrounds them (constexpr is what lets a function be that and belong to no source); on a device a call would pass
/// the fields of an element through memory.
#if defined(__CUDACC__)
#define PLIANT_SELDOM PLIANT_HOST_DEVICE
#else
#define PLIANT_SELDOM [[gnu::noinline]] constexpr
#endif

namespace pliant {

/// The version of the library (semantic); its CMake package has the same.
inline constexpr struct Version {
  int major = 0, minor = 1, patch = 0;
} version{};

/// Numbers nodes and elements.
using Index = std::int32_t;

/// Tells which group an element belongs to; groups are numbered within an element table.
using Tag = std::uint8_t;

}  // namespace pliant

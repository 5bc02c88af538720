#pragma once

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

namespace pliant {

inline constexpr struct Version {
  int major = 0, minor = 1, patch = 0;
} version{};

/// Numbers nodes and elements.
using Index = std::int32_t;

/// Tells which group an element belongs to; groups are numbered within an element table.
using Tag = std::uint8_t;

}  // namespace pliant

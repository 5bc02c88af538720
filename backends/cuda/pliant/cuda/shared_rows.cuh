#pragma once

#include <pliant/cuda/vector_memory.cuh>

namespace pliant::detail {

/// All fields of a patch's nodes side by side in shared memory: M values per node, in pieces of 16
/// bytes or fewer, all first pieces first. So a warp that reads scattered nodes has few bank
/// conflicts.
template <class T, int M>
struct SharedRows {
  static constexpr int widest = 16 / sizeof(T);
  static constexpr int width = M % widest == 3 ? M + 1 : M;  // padding included

  static constexpr int bytes(int capacity) { return capacity * width * int{sizeof(T)}; }

  template <int From = 0>
  __device__ __forceinline__ void store(int r, T const* values) const {
    if constexpr (From < M) {
      constexpr int size = piece_size<T>(M - From);
      Piece<T, size> piece;
#pragma unroll
      for (int k = 0; k < size; ++k) piece.values[k] = From + k < M ? values[From + k] : T(0);
      reinterpret_cast<Piece<T, size>*>(data + From * capacity)[r] = piece;
      store<From + size>(r, values);
    }
  }
  template <int From = 0>
  __device__ __forceinline__ void load(int r, T* values) const {
    if constexpr (From < M) {
      constexpr int size = piece_size<T>(M - From);
      auto const piece = reinterpret_cast<Piece<T, size> const*>(data + From * capacity)[r];
#pragma unroll
      for (int k = 0; k < size && From + k < M; ++k) values[From + k] = piece.values[k];
      load<From + size>(r, values);
    }
  }

  T* data;
  int capacity;  // nodes; multiple of 4
};

}  // namespace pliant::detail

#pragma once

#include <cstdint>

#include <pliant/cuda/node_rows.cuh>

namespace pliant::detail {

/// What a block of accumulation keeps in shared memory, in this order.
template <class T, int Nodes, int C, int M>
struct PatchMemory {
  static constexpr int diagonal_bytes(int capacity) { return (capacity * 2 + 15) / 16 * 16; }
  static constexpr int bytes(int diagonal_capacity, int node_capacity, int patch_size) {
    return diagonal_bytes(diagonal_capacity) + NodeRows<T, M>::bytes(node_capacity) +
           patch_size * Nodes * C * int{sizeof(T)};
  }
  __device__ explicit PatchMemory(int diagonal_capacity, int node_capacity, char* memory)
      : diagonals(reinterpret_cast<std::uint16_t*>(memory)),
        rows{reinterpret_cast<T*>(memory + diagonal_bytes(diagonal_capacity)), node_capacity},
        staging(rows.data + NodeRows<T, M>::width * node_capacity) {}

  std::uint16_t* diagonals;
  NodeRows<T, M> rows;
  T* staging;  // (slots, C)
};

}  // namespace pliant::detail

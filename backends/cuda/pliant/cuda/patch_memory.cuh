#pragma once

#include <cstdint>

#include <pliant/cuda/shared_rows.cuh>
#include <pliant/cuda/slot_planner.hpp>

namespace pliant::detail {

/// What a block of accumulation keeps in shared memory, in this order.
template <class T, int C, int M>
struct PatchMemory {
  static constexpr int diagonal_bytes(int capacity) { return (capacity * 2 + 15) / 16 * 16; }
  static constexpr int bytes(PatchCounts const& capacity) {
    return diagonal_bytes(capacity.diagonals) + SharedRows<T, M>::bytes(capacity.nodes) +
           capacity.slots * C * int{sizeof(T)};
  }
  __device__ explicit PatchMemory(PatchCounts const& capacity, char* memory)
      : diagonals(reinterpret_cast<std::uint16_t*>(memory)),
        rows{reinterpret_cast<T*>(memory + diagonal_bytes(capacity.diagonals)), capacity.nodes},
        staging(rows.data + SharedRows<T, M>::width * capacity.nodes) {}

  std::uint16_t* diagonals;
  SharedRows<T, M> rows;
  T* staging;  // (slots, C)
};

}  // namespace pliant::detail

#pragma once

#include <pliant/backend/field.hpp>

// Memory in the widest pieces that one instruction moves.
namespace pliant::detail {

/// N values of T that one instruction moves.
template <class T, int N>
struct alignas(sizeof(T) * N) Piece {
  T values[N];
};

/// The values in the next piece when `remaining` of them are left: 16 bytes or fewer, and rather
/// padding behind the last value than a piece more.
template <class T>
constexpr int piece_size(int remaining) {
  int size = 1;
  while (size < remaining && 2 * size * int{sizeof(T)} <= 16) size *= 2;
  return size;
}

/// An object in registers as it came from memory, for objects whose address and size are multiples
/// of 16 bytes. Small members take a register each once they are unpacked, so that is left for
/// late.
template <class U>
struct Packed {
  static_assert(sizeof(U) % 16 == 0 && alignof(U) % 16 == 0);
  Piece<std::uint32_t, 4> pieces[sizeof(U) / 16];

  __device__ __forceinline__ static Packed load(U const* address) {
    Packed packed;
#pragma unroll
    for (std::size_t k = 0; k < sizeof(U) / 16; ++k)
      packed.pieces[k] = reinterpret_cast<Piece<std::uint32_t, 4> const*>(address)[k];
    return packed;
  }
  __device__ __forceinline__ U unpacked() const {
    U value;
    __builtin_memcpy(&value, pieces, sizeof(U));
    return value;
  }
};

/// The N values at an address that is aligned for a padded node.
template <int N, int From = 0, class T>
__device__ __forceinline__ void load_padded(T const* address, T* values) {
  if constexpr (From < N) {
    constexpr int size = piece_size<T>(N - From);
    using P = Piece<T, size>;
    P const piece = *reinterpret_cast<P const*>(address + From);
#pragma unroll
    for (int k = 0; k < size && From + k < N; ++k) values[From + k] = piece.values[k];
    load_padded<N, From + size>(address, values);
  }
}

/// Values per instruction in rows of C values without padding.
template <class T, int C>
inline constexpr int row_piece = C % 4 == 0 && sizeof(T) == 4 ? 4
                                 : C % 2 == 0                 ? 2
                                                              : 1;

template <int C, class T>
__device__ __forceinline__ void load_values(T const* address, T* values) {
  constexpr int size = row_piece<T, C>;
#pragma unroll
  for (int k = 0; k < C; k += size) {
    auto const piece = *reinterpret_cast<Piece<T, size> const*>(address + k);
#pragma unroll
    for (int i = 0; i < size; ++i) values[k + i] = piece.values[i];
  }
}
template <int C, class T>
__device__ __forceinline__ void store_values(T* address, T const* values) {
  constexpr int size = row_piece<T, C>;
#pragma unroll
  for (int k = 0; k < C; k += size) {
    Piece<T, size> piece;
#pragma unroll
    for (int i = 0; i < size; ++i) piece.values[i] = values[k + i];
    *reinterpret_cast<Piece<T, size>*>(address + k) = piece;
  }
}

/// The values of a field at a node.
template <class U, int C>
__device__ __forceinline__ void load_node(NodeField<U, C> const& field, Index node,
                                          std::remove_const_t<U>* values) {
  static_assert(C <= node_stride);
  load_padded<C>(const_cast<std::remove_const_t<U> const*>(
                     field.data + static_cast<std::ptrdiff_t>(node_stride) * node),
                 values);
}

/// The values of a field at the nodes of an element whose padded row of connectivity is given.
template <int Nodes, class U, int C>
__device__ __forceinline__ auto gather_nodes(NodeField<U, C> const& field, Index const* row) {
  Index nodes[Nodes];
  load_padded<Nodes>(row, nodes);
  Matrix<std::remove_const_t<U>, Nodes, C> values;
#pragma unroll
  for (int a = 0; a < Nodes; ++a) load_node(field, nodes[a], values.entries[a]);
  return values;
}

/// Adds to a node, whatever other threads add to it.
template <class T, int C>
__device__ __forceinline__ void add_to_node(NodeField<T, C> const& field, Index node,
                                            T const* values) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 900
  constexpr bool as_vectors = false;
#else
  constexpr bool as_vectors = std::same_as<T, float>;
#endif
  T* const address = field.data + static_cast<std::ptrdiff_t>(node_stride) * node;
  if constexpr (as_vectors && C >= 3) {
    asm volatile(
        "red.global.add.v4.f32 [%0], {%1, %2, %3, %4};" ::"l"(__cvta_generic_to_global(address)),
        "f"(values[0]), "f"(values[1]), "f"(values[2]), "f"(C == 4 ? values[C - 1] : 0)
        : "memory");
  } else if constexpr (as_vectors && C == 2) {
    asm volatile("red.global.add.v2.f32 [%0], {%1, %2};" ::"l"(__cvta_generic_to_global(address)),
                 "f"(values[0]), "f"(values[1])
                 : "memory");
  } else {
#pragma unroll
    for (int k = 0; k < C; ++k) atomicAdd(address + k, values[k]);
  }
}

}  // namespace pliant::detail

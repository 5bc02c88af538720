#pragma once

#include <utility>

#include <pliant/backend/field.hpp>
#include <pliant/openmp/pack.hpp>

// Nodes are padded to four values, so four nodes and four components are 4×4 blocks. Moving them
// between memory (a node per row) and packs (a component per register) by shuffles is faster than
// hardware gathers and scatters. Packs of two lanes move half a node at a time, in 2×2 blocks.
namespace pliant::detail {

/// Lane by lane, the index of a shuffle of two registers a and b of L lanes (b's begin at L).
template <int L, int Step>
constexpr int shuffle_index(int lane) {
  int const block = lane / 4 * 4, k = lane % 4;
  switch (Step) {
    case 0:  // a0 b0 a1 b1
      return block + k / 2 + (k % 2) * L;
    case 1:  // a2 b2 a3 b3
      return block + 2 + k / 2 + (k % 2) * L;
    case 2:  // a0 a1 b0 b1
      return block + k % 2 + (k / 2) * L;
    default:  // a2 a3 b2 b3
      return block + 2 + k % 2 + (k / 2) * L;
  }
}

template <int Step, class Register, std::size_t... I>
PLIANT_HOST_DEVICE Register shuffle(Register a, Register b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, shuffle_index<int{sizeof...(I)}, Step>(int{I})...);
}

/// The 4×4 transpose inside each block of four lanes, across four registers. Its own inverse.
template <class T, int L>
PLIANT_HOST_DEVICE void transpose_blocks(typename Pack<T, L>::Register (&r)[4]) {
  constexpr auto lanes = std::make_index_sequence<L>();
  auto const low01 = shuffle<0>(r[0], r[1], lanes), high01 = shuffle<1>(r[0], r[1], lanes);
  auto const low23 = shuffle<0>(r[2], r[3], lanes), high23 = shuffle<1>(r[2], r[3], lanes);
  r[0] = shuffle<2>(low01, low23, lanes);
  r[1] = shuffle<3>(low01, low23, lanes);
  r[2] = shuffle<2>(high01, high23, lanes);
  r[3] = shuffle<3>(high01, high23, lanes);
}

template <class A, std::size_t... I>
PLIANT_HOST_DEVICE auto join(A a, A b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, I...);
}

/// The padded values of one node.
template <class T>
struct NodeVector {
  typedef T type __attribute__((vector_size(sizeof(T) * node_stride)));
};

/// `Lanes` values: the nodes index[0], index[stride], ... side by side, four values each.
template <class T, int Lanes>
PLIANT_HOST_DEVICE auto load_nodes(T const* data, Index const* index, int stride) {
  if constexpr (Lanes == 4) {
    typename NodeVector<T>::type node;
    __builtin_memcpy(&node, data + std::ptrdiff_t{node_stride} * *index, sizeof(node));
    return node;
  } else {
    constexpr int half = Lanes / 2;
    return join(load_nodes<T, half>(data, index, stride),
                load_nodes<T, half>(data, index + half / 4 * stride, stride),
                std::make_index_sequence<Lanes>());
  }
}

template <class T, class Register, std::size_t... I>
PLIANT_HOST_DEVICE typename NodeVector<T>::type extract(Register r, std::index_sequence<I...>) {
  return __builtin_shufflevector(r, r, I...);
}
template <int Offset, std::size_t... I>
constexpr auto offset_sequence(std::index_sequence<I...>) {
  return std::index_sequence<Offset + I...>();
}

/// The 2×2 transpose across two registers of two lanes. Its own inverse.
template <class Register>
PLIANT_HOST_DEVICE void transpose_pair(Register& a, Register& b) {
  Register const low = __builtin_shufflevector(a, b, 0, 2);
  b = __builtin_shufflevector(a, b, 1, 3);
  a = low;
}

/// Components 0..3 of the nodes index[0..L), a component per register.
template <class T, int L>
PLIANT_HOST_DEVICE void gather_nodes(T const* data, Index const (&index)[L],
                                     typename Pack<T, L>::Register (&r)[4])
  requires(L == 2)
{
  for (int half = 0; half < 4; half += 2) {
    for (int k = 0; k < 2; ++k)
      __builtin_memcpy(&r[half + k], data + std::ptrdiff_t{node_stride} * index[k] + half,
                       sizeof(r[0]));
    transpose_pair(r[half], r[half + 1]);
  }
}
template <class T, int L>
PLIANT_HOST_DEVICE void gather_nodes(T const* data, Index const (&index)[L],
                                     typename Pack<T, L>::Register (&r)[4])
  requires(L >= 4)
{
  for (int k = 0; k < 4; ++k) r[k] = load_nodes<T, L>(data, index + k, 4);
  transpose_blocks<T, L>(r);
}

/// Adds components 0..3, a component per register, to the nodes index[0..count). Nodes may repeat.
template <class T, int L>
PLIANT_HOST_DEVICE void scatter_add_nodes(T* data, Index const (&index)[L], int count,
                                          typename Pack<T, L>::Register (&r)[4])
  requires(L == 2)
{
  for (int half = 0; half < 4; half += 2) transpose_pair(r[half], r[half + 1]);
  for (int k = 0; k < count; ++k)
    for (int half = 0; half < 4; half += 2) {
      T* const address = data + std::ptrdiff_t{node_stride} * index[k] + half;
      typename Pack<T, L>::Register sum;
      __builtin_memcpy(&sum, address, sizeof(sum));
      sum += r[half + k];
      __builtin_memcpy(address, &sum, sizeof(sum));
    }
}
template <class T, int L>
PLIANT_HOST_DEVICE void scatter_add_nodes(T* data, Index const (&index)[L], int count,
                                          typename Pack<T, L>::Register (&r)[4])
  requires(L >= 4)
{
  transpose_blocks<T, L>(r);
  auto const add = [&]<int Block>(std::integral_constant<int, Block>) PLIANT_INLINE {
    for (int k = 0; k < 4; ++k) {
      if (4 * Block + k >= count) return;
      T* const address = data + std::ptrdiff_t{node_stride} * index[4 * Block + k];
      typename NodeVector<T>::type node;
      __builtin_memcpy(&node, address, sizeof(node));
      node += extract<T>(r[k], offset_sequence<4 * Block>(std::make_index_sequence<4>()));
      __builtin_memcpy(address, &node, sizeof(node));
    }
  };
  [&]<int... B>(std::integer_sequence<int, B...>) PLIANT_INLINE {
    (add(std::integral_constant<int, B>()), ...);
  }(std::make_integer_sequence<int, L / 4>());
}

}  // namespace pliant::detail

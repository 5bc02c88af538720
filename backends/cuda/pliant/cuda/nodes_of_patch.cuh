#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_memory.cuh>
#include <pliant/cuda/vector_memory.cuh>

// What all loops over patches do: nodes to shared memory first, the sums of their slots to global memory last.
namespace pliant::detail {

/// Some columns of the node rows of an element.
template <int Offset, int C, class T, int Nodes, int M>
__device__ __forceinline__ Matrix<T, Nodes, C> columns(T const (&rows)[Nodes][M]) {
  Matrix<T, Nodes, C> values;
#pragma unroll
  for (int a = 0; a < Nodes; ++a)
#pragma unroll
    for (int k = 0; k < C; ++k) values(a, k) = rows[a][Offset + k];
  return values;
}

/// kernel(group, fields...) with the fields cut out of node rows.
template <int... C, class Group, class Kernel, class T, int Nodes, int M>
__device__ __forceinline__ auto call_on_rows(Kernel const& kernel, Group group, Index e,
                                             T const (&rows)[Nodes][M]) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    constexpr auto offset = [](std::size_t field) {
      int const sizes[] = {C...};
      int sum = 0;
      for (std::size_t k = 0; k < field; ++k) sum += sizes[k];
      return sum;
    };
    return call(kernel, group, OneElement{e}, columns<offset(I), C>(rows)...);
  }(std::make_index_sequence<sizeof...(C)>());
}

/// The nodes of a block's patch.
struct NodesOfPatch {
  PatchNode const* nodes;
  int capacity;

  __device__ __forceinline__ Index node(Index r) const { return r < capacity ? nodes[r].node : -1; }
  __device__ __forceinline__ PatchNode at(Index r) const {
    return r < capacity ? nodes[r] : PatchNode{};
  }

  /// The nodes that a thread loads first, several at a time.
  template <int AtOnce>
  struct Batch {
    Index node[AtOnce];
  };
  template <int AtOnce>
  __device__ __forceinline__ Batch<AtOnce> batch(Index r) const {
    Batch<AtOnce> nodes;
#pragma unroll
    for (int j = 0; j < AtOnce; ++j) nodes.node[j] = node(r + j * static_cast<Index>(blockDim.x));
    return nodes;
  }

  /// The fields of all nodes to shared memory; `next` is the batch of the thread's number.
  template <int AtOnce, class T, int M, class... Fields>
  __device__ __forceinline__ void load(SharedRows<T, M> const& rows, Batch<AtOnce> next,
                                       Fields const&... fields) const {
    Index const threads = static_cast<Index>(blockDim.x);
#pragma unroll 1
    for (Index r = static_cast<Index>(threadIdx.x); next.node[0] >= 0; r += AtOnce * threads) {
      auto const own = next;
      next = batch<AtOnce>(r + AtOnce * threads);
      T row[AtOnce][M];
#pragma unroll
      for (int j = 0; j < AtOnce; ++j) {
        if (own.node[j] < 0) break;  // behind the patch's last
        int offset = 0;
        ((load_node(fields, own.node[j], row[j] + offset), offset += Fields::components), ...);
      }
#pragma unroll
      for (int j = 0; j < AtOnce; ++j)
        if (own.node[j] >= 0) rows.store(r + j * threads, row[j]);
    }
  }

  /// The sums of all nodes' slots to `out`; `next` is that of the thread's number.
  template <class T, int C>
  __device__ __forceinline__ void add_sums(NodeField<T, C> const& out,
                                           std::uint16_t const* diagonals, T const* staging,
                                           PatchNode next) const {
    Index const threads = static_cast<Index>(blockDim.x);
#pragma unroll 1
    for (Index r = static_cast<Index>(threadIdx.x); r < capacity; r += threads) {
      PatchNode const n = next;
      if (n.valence == 0) break;  // behind the patch's last
      next = at(r + threads);
      T sum[C] = {};
#pragma unroll 4
      for (int d = 0; d < n.valence; ++d) {
        T share[C];
        load_values<C>(staging + C * (diagonals[d] + r), share);
#pragma unroll
        for (int k = 0; k < C; ++k) sum[k] += share[k];
      }
      add_to_node(out, n.node, sum);
    }
  }
};

}  // namespace pliant::detail

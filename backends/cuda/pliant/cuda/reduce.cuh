#pragma once

#include <tuple>

#include <cuda/std/limits>

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/vector_memory.cuh>

namespace pliant::detail {

struct Sum {
  __device__ static double identity() { return 0; }
  __device__ static double combine(double a, double b) { return a + b; }
  __device__ static void store(double value, double* to) { *to = value; }
};
/// A sum that is added to what is there.
struct AddedSum : Sum {
  __device__ static void store(double value, double* to) { *to += value; }
};
struct Maximum {
  __device__ static double identity() { return -cuda::std::numeric_limits<double>::infinity(); }
  __device__ static double combine(double a, double b) { return a < b ? b : a; }
  __device__ static void store(double value, double* to) { *to = value; }
};

/// The block's values combined in a fixed order; thread 0 has the result.
template <class Reduction>
__device__ double reduce_block(double value) {
  __shared__ double of_warp[1024 / warp_size];
  int const lane = static_cast<int>(threadIdx.x) % warp_size;
  auto const within_warp = [](double v) {
    for (int step = warp_size / 2; step > 0; step /= 2)
      v = Reduction::combine(v, __shfl_down_sync(0xffffffffu, v, step));
    return v;
  };
  value = within_warp(value);
  if (lane == 0) of_warp[threadIdx.x / warp_size] = value;
  __syncthreads();
  if (threadIdx.x >= warp_size) return value;
  return within_warp(lane < static_cast<int>(blockDim.x) / warp_size ? of_warp[lane]
                                                                     : Reduction::identity());
}

/// Each block notes what it has; the last one to do so combines what all noted, in the order of blocks. blocks_done: zero before
/// and after.
template <class Reduction, class F>
__global__ void __launch_bounds__(reduce_threads)
    reduce_all(Index n, __grid_constant__ F const f, double* partials, unsigned* blocks_done,
               double* result) {
  begin_after_previous_kernel();
  double value = Reduction::identity();
  // 64 bits: the last step may pass the largest Index.
  for (std::int64_t i = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; i < n;
       i += std::int64_t{gridDim.x} * blockDim.x)
    value = Reduction::combine(value, static_cast<double>(f(static_cast<Index>(i))));
  value = reduce_block<Reduction>(value);
  if (gridDim.x > 1) {
    __shared__ bool is_last;
    if (threadIdx.x == 0) {
      partials[blockIdx.x] = value;
      __threadfence();
      is_last = atomicInc(blocks_done, gridDim.x - 1) == gridDim.x - 1;
    }
    __syncthreads();
    if (!is_last) return;
    __threadfence();
    value = Reduction::identity();
    for (unsigned b = threadIdx.x; b < gridDim.x; b += reduce_threads)
      value = Reduction::combine(value, __ldcg(partials + b));
    value = reduce_block<Reduction>(value);
  }
  if (threadIdx.x == 0) Reduction::store(value, result);
}

/// A kernel's value of an element, as a function of its number among the active ones.
template <int Groups, int Nodes, class Kernel, class... Fields>
struct ElementTerm {
  ElementView<Nodes> elements;
  Kernel kernel;
  std::tuple<Fields...> fields;

  __device__ double operator()(Index i) const {
    Index const e = elements.element(i);
    return e < 0 ? 0 : of(e);
  }
  __device__ double of(Index e) const {
    double value = 0;
    Index const* const row =
        elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * e;
    dispatch<Groups>(elements.tags[e], [&](auto group) {
      value = std::apply(
          [&](auto const&... field) {
            return static_cast<double>(
                call(kernel, group, OneElement{e}, gather_nodes<Nodes>(field, row)...));
          },
          fields);
    });
    return value;
  }
};
/// The same of the element at a place; −1: zero.
template <class Term, class Places>
struct TermAt {
  Term term;
  Places places;
  __device__ double operator()(Index i) const {
    Index const e = places[i];
    return e < 0 ? 0 : term.of(e);
  }
};

}  // namespace pliant::detail

#pragma once

#include <cstdint>

#include <pliant/backend/backend.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/tuning.hpp>

namespace pliant::detail {

/// A histogram per block in shared memory, added to the one in global memory at the end. A warp whose values
/// fall into one bin, as the leading digits of like numbers do, adds them up first.
template <class F>
__global__ void __launch_bounds__(reduce_threads)
    add_to_histogram(Index n, __grid_constant__ F const f, std::int64_t* bins) {
  static_assert(reduce_threads >= histogram_bins);
  using Sum = unsigned long long;  // additions wrap, so that signed weights are right too
  __shared__ Sum own[histogram_bins];
  int const thread = static_cast<int>(threadIdx.x);
  if (thread < histogram_bins) own[thread] = 0;
  __syncthreads();
  begin_after_previous_kernel();
  constexpr unsigned all = 0xffffffffu;
  // Whole warps stay together; 64 bits: the last step may pass the largest Index.
  for (std::int64_t first = std::int64_t{blockIdx.x} * reduce_threads; first < n;
       first += std::int64_t{gridDim.x} * reduce_threads) {
    std::int64_t const i = first + thread;
    Bin const bin = i < n ? f(static_cast<Index>(i)) : Bin{-1, 0};
    int alike = 0;
    __match_all_sync(all, bin.number, &alike);
    if (alike != 0) {
      if (bin.number < 0) continue;
      Sum weight = static_cast<Sum>(bin.weight);
      for (int step = warp_size / 2; step > 0; step /= 2)
        weight += __shfl_down_sync(all, weight, step);
      if (thread % warp_size == 0) atomicAdd(own + bin.number, weight);
    } else if (bin.number >= 0) {
      atomicAdd(own + bin.number, static_cast<Sum>(bin.weight));
    }
  }
  __syncthreads();
  if (thread < histogram_bins && own[thread] != 0)
    atomicAdd(reinterpret_cast<Sum*>(bins) + thread, own[thread]);
}

}  // namespace pliant::detail

#pragma once

#include <omp.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include <pliant/backend/first_exception.hpp>
#include <pliant/backend/function_ref.hpp>

namespace pliant::detail {

/// Loops on a number of threads. What does not pay for waking them runs on the caller's alone, with no
/// call of the OpenMP runtime.
class Threads {
 public:
  explicit Threads(int count) : count_(count) {}
  int count() const { return count_; }

  /// Calls f(first, last) with a part of [0, n) on each thread; on one up to n = `few`.
  void for_each_part(Index n, Index few, FunctionRef<void(Index, Index)> f) const {
    if (count_ == 1 || n <= few) return f(0, n);
    FirstException thrown;
#pragma omp parallel num_threads(count_)
    {
      Part const part(n);
      thrown.guard(part.first, [&] { f(part.first, part.last); });
    }
    thrown.rethrow();
  }
  /// Calls f(block) for each block of work; then g(first, last) with a part of [0, n) on each thread, where f is done
  /// with all blocks.
  void for_each_block(Index blocks, FunctionRef<void(Index)> f, Index n,
                      FunctionRef<void(Index, Index)> g) const {
    if (count_ == 1 || blocks < 2) {
      for (Index b = 0; b < blocks; ++b) f(b);
      return g(0, n);
    }
    FirstException thrown;
    SharedBlocks shared(blocks, count_);
#pragma omp parallel num_threads(count_)
    {
      for (Index b; (b = shared.next(omp_get_thread_num())) >= 0;) thrown.guard(b, [&] { f(b); });
#pragma omp barrier
      Part const part(n);
      g(part.first, part.last);
    }
    thrown.rethrow();
  }
  void for_each_block(Index blocks, FunctionRef<void(Index)> f) const {
    for_each_block(blocks, f, 0, [](Index, Index) {});
  }

 private:
  /// Blocks in as many runs as there are threads. Each thread takes those of its own run first, whose data its caches
  /// may still have from the last loop, then what others have left.
  class SharedBlocks {
   public:
    SharedBlocks(Index blocks, int threads) : runs_(static_cast<std::size_t>(threads)) {
      std::int64_t const n = blocks;
      for (int t = 0; t < threads; ++t) {
        Run& run = runs_[static_cast<std::size_t>(t)];
        run.next = static_cast<Index>(t * n / threads);
        run.last = static_cast<Index>((t + 1) * n / threads);
      }
    }
    /// −1: all are taken.
    Index next(int thread) {
      auto const count = static_cast<int>(runs_.size());
      for (int k = 0; k < count; ++k) {
        Run& run = runs_[static_cast<std::size_t>((thread + k) % count)];
        if (run.next.load(std::memory_order_relaxed) >= run.last) continue;
        Index const block = run.next.fetch_add(1, std::memory_order_relaxed);
        if (block < run.last) return block;
      }
      return -1;
    }

   private:
    struct alignas(64) Run {
      std::atomic<Index> next;
      Index last;
    };
    std::vector<Run> runs_;
  };
  /// That of the calling thread in a parallel region.
  struct Part {
    Index first, last;
    explicit Part(Index n) {
      std::int64_t const thread = omp_get_thread_num(), threads = omp_get_num_threads();
      first = static_cast<Index>(thread * n / threads);
      last = static_cast<Index>((thread + 1) * n / threads);
    }
  };

  int count_;
};

}  // namespace pliant::detail

#pragma once

#include <omp.h>

#include <cstdint>
#include <exception>

#include <pliant/config.hpp>

namespace pliant::detail {

/// Carries an exception out of a parallel region, which none may leave by itself: the one that a
/// serial loop would have met first, whatever thread meets its own first.
class FirstException {
 public:
  /// Calls work(), which has place `at` in the serial order; keeps what it throws.
  template <class F>
  PLIANT_INLINE void guard(Index at, F const& work) {
    try {
      work();
    } catch (...) {
      keep(at);
    }
  }
  /// Behind the parallel region.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  [[gnu::cold, gnu::noinline]] void keep(Index at) {
#pragma omp critical(pliant_first_exception)
    if (!thrown_ || at < at_) {
      thrown_ = std::current_exception();
      at_ = at;
    }
  }

  std::exception_ptr thrown_;
  Index at_ = 0;
};

/// Loops on a number of threads. What does not pay for waking them runs on the caller's alone, with no
/// call of the OpenMP runtime.
class Threads {
 public:
  explicit Threads(int count) : count_(count) {}
  int count() const { return count_; }

  /// Calls f(first, last) with a part of [0, n) on each thread; on one up to n = `few`.
  template <class F>
  void for_each_part(Index n, Index few, F const& f) const {
    if (count_ == 1 || n <= few) return f(Index{0}, n);
    FirstException thrown;
#pragma omp parallel num_threads(count_)
    {
      std::int64_t const part = omp_get_thread_num(), parts = omp_get_num_threads();
      auto const first = static_cast<Index>(part * n / parts);
      thrown.guard(first, [&] { f(first, static_cast<Index>((part + 1) * n / parts)); });
    }
    thrown.rethrow();
  }
  /// Calls f(block) for each block of work; then g(k) for each k < n, where f is done with all blocks.
  template <class F, class G>
  void for_each_block(Index blocks, F const& f, Index n, G const& g) const {
    if (count_ == 1 || blocks < 2) {
      for (Index b = 0; b < blocks; ++b) f(b);
      for (Index k = 0; k < n; ++k) g(k);
      return;
    }
    FirstException thrown;
#pragma omp parallel num_threads(count_)
    {
#pragma omp for schedule(dynamic)
      for (Index b = 0; b < blocks; ++b) thrown.guard(b, [&] { f(b); });
#pragma omp for schedule(static)
      for (Index k = 0; k < n; ++k) g(k);
    }
    thrown.rethrow();
  }
  template <class F>
  void for_each_block(Index blocks, F const& f) const {
    if (count_ == 1 || blocks < 2) {
      for (Index b = 0; b < blocks; ++b) f(b);
      return;
    }
    FirstException thrown;
#pragma omp parallel for schedule(dynamic) num_threads(count_)
    for (Index b = 0; b < blocks; ++b) thrown.guard(b, [&] { f(b); });
    thrown.rethrow();
  }

 private:
  int count_;
};

}  // namespace pliant::detail

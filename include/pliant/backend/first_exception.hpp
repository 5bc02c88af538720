#pragma once

#include <exception>
#include <mutex>

#include <pliant/config.hpp>

namespace pliant::detail {

/// Carries an exception out of a loop on several threads, which none may leave by itself: the one that a
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
  /// Behind the loop.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  [[gnu::cold, gnu::noinline]] void keep(Index at) {
    std::lock_guard const lock(mutex_);
    if (!thrown_ || at < at_) {
      thrown_ = std::current_exception();
      at_ = at;
    }
  }

  std::mutex mutex_;
  std::exception_ptr thrown_;
  Index at_ = 0;
};

}  // namespace pliant::detail

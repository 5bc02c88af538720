#pragma once

#include <algorithm>
#include <functional>

#include <pliant/backend/function_ref.hpp>
#include <pliant/config.hpp>

namespace pliant {

/// Calls functions of the host for numbers 0, 1, ..., on the threads of a backend that has some there
/// (`for_each_task`), or one after the other.
class HostTasks {
 public:
  HostTasks() = default;
  /// The backend has to live longer.
  template <class B>
  explicit HostTasks(B const& backend) {
    if constexpr (requires(FunctionRef<void(Index)> f) {
                    backend.for_each_task(Index{}, f);
                    backend.threads();
                  }) {
      threads_ = backend.threads();
      run_ = [&backend](Index n, FunctionRef<void(Index)> f) { backend.for_each_task(n, f); };
    }
  }

  int threads() const { return threads_; }
  /// f(k) for each k < n; as tasks worth a thread each.
  void operator()(Index n, FunctionRef<void(Index)> f) const {
    if (run_ && n > 1) return run_(n, f);
    for (Index k = 0; k < n; ++k) f(k);
  }
  /// f(first, last) for parts of [0, n) that together are all of it, none shorter than `few` where there are several.
  template <class F>
  void in_parts(Index n, Index few, F const& f) const {
    Index const parts = std::clamp<Index>(n / few, 1, 4 * threads_);
    if (threads_ == 1 || parts == 1) return f(Index{0}, n);
    (*this)(parts, [&](Index k) {
      auto const border = [&](Index of) {
        return static_cast<Index>(std::int64_t{n} * of / parts);
      };
      f(border(k), border(k + 1));
    });
  }

 private:
  int threads_ = 1;
  std::function<void(Index, FunctionRef<void(Index)>)> run_;
};

}  // namespace pliant

#pragma once

#include <cstdint>

#include <pliant/backend/backend.hpp>

// Loops that follow each other. Where all of them are short, launching each takes a GPU longer than running it: a backend that has
// `in_turn` makes one launch of them.
namespace pliant::detail {

/// for_each of a backend.
template <class F>
struct LoopStep {
  Index n;
  F f;
  template <class B>
  void run(B const& backend) const {
    backend.for_each(n, f);
  }
};
template <class F>
LoopStep(Index, F) -> LoopStep<F>;

/// scan of a backend.
template <class F>
struct ScanStep {
  Index n;
  F f;
  Index* to;
  template <class B>
  void run(B const& backend) const {
    backend.scan(n, f, to);
  }
};
template <class F>
ScanStep(Index, F, Index*) -> ScanStep<F>;

/// sort of a backend.
struct SortStep {
  Index n;
  std::uint64_t* keys;
  Index* values;
  int bits;
  template <class B>
  void run(B const& backend) const {
    backend.sort(n, keys, values, bits);
  }
};

/// Runs steps one after the other, each of which sees what those before it wrote. Waits for nothing.
template <Backend B, class... Steps>
void in_turn(B const& backend, Steps const&... steps) {
  if constexpr (sizeof...(Steps) > 1 && requires { backend.in_turn(steps...); })
    backend.in_turn(steps...);
  else
    (steps.run(backend), ...);
}

}  // namespace pliant::detail

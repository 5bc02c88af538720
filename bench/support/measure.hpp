#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>

#include <pliant/backend/backend.hpp>

// How time is taken: by the wall clock, around so many repetitions of the work that starting it and
// waiting for its end do not count.
namespace pliant::bench {

/// Seconds from the start of f() to the end of what it asked of the backend.
template <class B, class F>
double seconds(B const& backend, F const& f) {
  using Clock = std::chrono::steady_clock;
  backend.synchronize();
  auto const start = Clock::now();
  f();
  backend.synchronize();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a benchmark finds in its first call and keeps for the others: every repetition has to do as
/// many iterations.
struct Kept {
  int in_graph = 0, replays = 0;  // 0: not known yet
  std::shared_ptr<void> state;
};

/// That of the benchmark that runs now.
inline Kept*& kept_by_this_benchmark() {
  static Kept* kept = nullptr;
  return kept;
}

/// run(state), with what is kept from call to call until the next benchmark begins.
template <class Run>
auto with_memory(Run run) {
  return [run, own = std::make_shared<Kept>()](benchmark::State& state) {
    Kept*& current = kept_by_this_benchmark();
    if (current != nullptr && current != own.get()) current->state.reset();
    current = own.get();
    run(state);
  };
}

/// What make() made in the first call of this benchmark.
template <class Make>
auto& made_once(Make const& make) {
  using Value = decltype(make());
  auto& state = kept_by_this_benchmark()->state;
  if (!state) state = std::make_shared<Value>(make());
  return *static_cast<Value*>(state.get());
}

/// Repetitions under one reading of the clock.
inline int replays_for(double seconds_of_one) {
  return static_cast<int>(std::clamp(std::ceil(4e-3 / seconds_of_one), 1.0, 4096.0));
}

/// Times repeat(n), which does the work n times.
template <class B, class Repeat>
void measure_repeats(benchmark::State& state, B const& backend, Repeat const& repeat) {
  int& n = kept_by_this_benchmark()->replays;
  repeat(1);
  if (n == 0) n = replays_for(seconds(backend, [&] { repeat(1); }));
  while (state.KeepRunningBatch(n)) state.SetIterationTime(seconds(backend, [&] { repeat(n); }));
}

/// Times work as a user calls it.
template <class B, class F>
void measure_calls(benchmark::State& state, B const& backend, F const& work) {
  measure_repeats(state, backend, [&](int n) {
    for (int k = 0; k < n; ++k) work();
  });
}

/// Times work of verbs that return nothing. A GPU replays it as a graph, short work several times
/// over, so that what the host does for a launch does not count.
template <class B, class F>
void measure(benchmark::State& state, B const& backend, F const& work) {
  int& in_graph = kept_by_this_benchmark()->in_graph;
  int& replays = kept_by_this_benchmark()->replays;
  work();
  if (in_graph == 0) in_graph = seconds(backend, work) < 2e-4 ? 16 : 1;
  auto const recording = backend.record([&work, copies = in_graph] {
    for (int k = 0; k < copies; ++k) work();
  });
  recording.replay(1);
  if (replays == 0) replays = replays_for(seconds(backend, [&] { recording.replay(1); }));
  while (state.KeepRunningBatch(replays * in_graph))
    state.SetIterationTime(seconds(backend, [&] { recording.replay(replays); }));
}

}  // namespace pliant::bench

#pragma once

#include <optional>

namespace pliant {

/// Where the time of adaptation goes: evaluating criteria and deciding; moving elements.
template <class B>
struct AdaptationWatches {
  struct Watch {
    std::optional<typename B::Stopwatch> watch;  // empty: stands still
    void start() {
      if (watch) watch->start();
    }
    void stop() {
      if (watch) watch->stop();
    }
    double seconds() { return watch ? watch->seconds() : 0.0; }
  } criteria, migration;
};

}  // namespace pliant

#pragma once

#include <optional>

namespace pliant {

/// Where the time of adaptation goes: evaluating criteria and deciding; moving elements.
template <class B>
struct AdaptationTimers {
  struct Optional {
    std::optional<typename B::Timer> timer;  // empty: stands still
    void start() {
      if (timer) timer->start();
    }
    void stop() {
      if (timer) timer->stop();
    }
    double seconds() { return timer ? timer->seconds() : 0.0; }
  } criteria, migration;
};

}  // namespace pliant

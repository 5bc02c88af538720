#pragma once

#include <optional>

namespace pliant {

/// Where the time of adaptation goes: evaluating criteria and deciding; moving elements.
template <class B>
struct AdaptationTimers {
  struct Optional {
    std::optional<typename B::Timer> timer;  // empty: stands still
    /// Measures while it lives, whether what is measured throws or not.
    class Measurement {
     public:
      explicit Measurement(std::optional<typename B::Timer>& timer) : timer_(timer) {
        if (timer_) timer_->start();
      }
      ~Measurement() {
        try {
          if (timer_) timer_->stop();
        } catch (...) {  // a GPU that fails here fails at the next call too
        }
      }
      Measurement(Measurement const&) = delete;

     private:
      std::optional<typename B::Timer>& timer_;
    };
    [[nodiscard]] Measurement measure() { return Measurement(timer); }
    double seconds() { return timer ? timer->seconds() : 0.0; }
  } criteria, migration;
};

}  // namespace pliant

#pragma once

#include <ctime>

namespace pliant {

/// The timer of the backends that run on the host.
class HostTimer {
 public:
  void start() { started_ = now(); }
  void stop() { seconds_ += now() - started_; }
  double seconds() { return seconds_; }

  /// s, since some moment.
  // Not <chrono>, which takes long to compile.
  static double now() {
    std::timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

 private:
  double started_ = 0, seconds_ = 0;
};

}  // namespace pliant

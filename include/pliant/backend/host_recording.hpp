#pragma once

#include <functional>
#include <utility>

namespace pliant {

/// The recording of the backends that run on the host: the function itself.
class HostRecording {
 public:
  HostRecording() = default;
  explicit HostRecording(std::function<void()> f) : function_(std::move(f)) {}
  void replay(int n) const {
    for (int k = 0; k < n; ++k) function_();
  }

 private:
  std::function<void()> function_;
};

}  // namespace pliant

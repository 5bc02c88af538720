#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pliant/cuda/context.hpp>

namespace pliant {

/// Measures on the GPU, by pairs of events on the backend's stream: neither start() nor stop()
/// waits.
class CudaTimer {
 public:
  explicit CudaTimer(std::shared_ptr<detail::CudaContext> context) : context_(std::move(context)) {}

  void start() { running_.emplace_back(record(), nullptr); }
  void stop() {
    running_.back().second = record();
    if (running_.size() == most_running) collect();
  }
  /// Waits for what was measured.
  double seconds() {
    collect();
    return seconds_;
  }

 private:
  static constexpr std::size_t most_running = 4096;
  using Event = std::shared_ptr<CUevent_st>;

  Event record() {
    context_->make_current();
    Event event;
    if (idle_.empty()) {
      cudaEvent_t made = nullptr;
      detail::check(cudaEventCreate(&made), "cudaEventCreate");
      event.reset(made, [](cudaEvent_t e) { cudaEventDestroy(e); });
    } else {
      event = std::move(idle_.back());
      idle_.pop_back();
    }
    detail::check(cudaEventRecord(event.get(), context_->stream()), "cudaEventRecord");
    return event;
  }
  void collect() {
    for (auto& [from, to] : running_) {
      float milliseconds = 0;
      detail::check(cudaEventSynchronize(to.get()), "cudaEventSynchronize");
      detail::check(cudaEventElapsedTime(&milliseconds, from.get(), to.get()),
                    "cudaEventElapsedTime");
      seconds_ += 1e-3 * static_cast<double>(milliseconds);
      idle_.push_back(std::move(from));
      idle_.push_back(std::move(to));
    }
    running_.clear();
  }

  std::shared_ptr<detail::CudaContext> context_;
  std::vector<std::pair<Event, Event>> running_;
  std::vector<Event> idle_;
  double seconds_ = 0;
};

}  // namespace pliant

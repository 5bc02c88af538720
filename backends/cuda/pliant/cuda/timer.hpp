#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pliant/cuda/stream.hpp>

namespace pliant {

/// Measures on the GPU, by pairs of events on the backend's stream: neither start() nor stop()
/// waits, unless the GPU is `most_running` measurements behind.
class CudaTimer {
 public:
  explicit CudaTimer(detail::SharedStream stream) : stream_(std::move(stream)) {}

  /// Begins a measurement; one that was not stopped is dropped.
  void start() {
    drop_open();
    if (running_.size() == most_running) collect(0);
    if (running_.size() == most_running) collect(1);
    running_.emplace_back(record(), nullptr);
  }
  /// Ends it; nothing where none is open.
  void stop() {
    if (is_open()) running_.back().second = record();
  }
  /// Waits for what was measured.
  double seconds() {
    collect(running_.size() - (is_open() ? 1 : 0));
    return seconds_;
  }

 private:
  static constexpr std::size_t most_running = 256;
  using Event = std::shared_ptr<CUevent_st>;

  bool is_open() const { return !running_.empty() && !running_.back().second; }
  void drop_open() {
    if (!is_open()) return;
    idle_.push_back(std::move(running_.back().first));
    running_.pop_back();
  }
  Event record() {
    Event event;
    if (idle_.empty()) {
      auto const device = stream_->enter();
      cudaEvent_t made = nullptr;
      detail::check(cudaEventCreate(&made), "cudaEventCreate");
      event.reset(made, [](cudaEvent_t e) { cudaEventDestroy(e); });
    } else {
      event = std::move(idle_.back());
      idle_.pop_back();
    }
    detail::check(cudaEventRecord(event.get(), stream_->get()), "cudaEventRecord");
    return event;
  }
  /// Waits for the first `waited` measurements; adds them and those after them that are finished.
  void collect(std::size_t waited) {
    std::size_t done = 0;
    for (; done < running_.size() && running_[done].second; ++done) {
      auto& [from, to] = running_[done];
      cudaError_t const status =
          done < waited ? cudaEventSynchronize(to.get()) : cudaEventQuery(to.get());
      if (status == cudaErrorNotReady) {
        cudaGetLastError();
        break;
      }
      detail::check(status, "cudaEventSynchronize");
      float milliseconds = 0;
      detail::check(cudaEventElapsedTime(&milliseconds, from.get(), to.get()),
                    "cudaEventElapsedTime");
      seconds_ += 1e-3 * static_cast<double>(milliseconds);
      idle_.push_back(std::move(from));
      idle_.push_back(std::move(to));
    }
    running_.erase(running_.begin(), running_.begin() + static_cast<std::ptrdiff_t>(done));
  }

  detail::SharedStream stream_;
  std::vector<std::pair<Event, Event>> running_;  // oldest first
  std::vector<Event> idle_;
  double seconds_ = 0;
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <concepts>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sched.h>
#endif

#include <pliant/backend/first_exception.hpp>
#include <pliant/backend/function_ref.hpp>

namespace pliant {

/// Threads of the host for what is computed there and by no backend: making, checking and numbering meshes. While one
/// lives, loops (detail::HostParts) of the thread that made it run on its threads, which start with the first
/// loop worth it, sleep between loops, and end with it; without one loops run on the caller's alone. Made while
/// another one of this thread lives, it leaves loops to that one. Results have the same bits for any number of threads.
class HostThreads {
 public:
  /// As many as the process may run on, or OMP_NUM_THREADS where that is less.
  HostThreads() : HostThreads(available()) {}
  explicit HostThreads(int most)
      : count_(std::clamp(most, 1, most_threads)), is_outermost_(current() == nullptr) {
    if (is_outermost_) current() = this;
  }
  /// No more than a backend has on the host, where it has some.
  template <class B>
    requires requires { typename B::scalar; }
  explicit HostThreads(B const& backend) : HostThreads(threads_of(backend)) {}
  /// For work on a mesh: 1 for a small one, which is done before threads have started.
  template <class M>
    requires(
        requires(M const& mesh) { mesh.tables; } ||
        requires(M const& mesh) { mesh.connectivity_size(); })
  explicit HostThreads(M const& mesh, int most = available())
      : HostThreads(worth(connectivity_size(mesh), most)) {}
  template <class B, class M>
    requires requires { typename B::scalar; }
  HostThreads(B const& backend, M const& mesh) : HostThreads(mesh, threads_of(backend)) {}
  ~HostThreads() {
    if (!is_outermost_) return;
    current() = nullptr;
    {
      std::lock_guard const lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    for (int k = 0; k < started_; ++k) helpers_[static_cast<std::size_t>(k)].join();
  }
  HostThreads(HostThreads const&) = delete;
  HostThreads& operator=(HostThreads const&) = delete;

  static int available() {
    int cores = static_cast<int>(std::thread::hardware_concurrency());
#if defined(__linux__)
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) cores = CPU_COUNT(&allowed);
#endif
    if (char const* const wanted = std::getenv("OMP_NUM_THREADS"))
      if (int const threads = std::atoi(wanted); threads > 0) cores = std::min(cores, threads);
    return std::clamp(cores, 1, most_threads);
  }
  /// How many threads work on elements is worth that have so many nodes in all, each counted by each of them.
  static int worth(std::size_t connectivity_size, int most = available()) {
    return connectivity_size < 100'000 ? 1 : most;
  }
  /// Those of the caller's loops: 1 inside of such a loop.
  static int now() {
    HostThreads const* const threads = current();
    return threads == nullptr || threads->in_loop_ ? 1 : threads->count_;
  }
  /// Whether the caller is in such a loop, beside other threads.
  static bool in_loop() { return current() != nullptr && current()->in_loop_; }
  /// task(k) for each k < count, in no order. Throws what the first of them throws.
  static void run(int count, FunctionRef<void(int)> task) {
    if (count > 1 && now() > 1) return current()->share(count, task);
    for (int k = 0; k < count; ++k) task(k);
  }

  static constexpr int most_threads = 64;  // more do not load memory faster

 private:
  /// A loop, of which threads take what is next.
  struct Loop {
    FunctionRef<void(int)> task;
    int count, room;  // room: for so many threads more
    std::atomic<int> next{0};
    detail::FirstException thrown{};
    void work() {
      for (int k = next++; k < count; k = next++) thrown.guard(k, [&] { task(k); });
    }
  };

  static HostThreads*& current() {
    static thread_local HostThreads* threads = nullptr;
    return threads;
  }
  template <class B>
  static int threads_of(B const& backend) {
    if constexpr (requires { backend.threads(); }) return backend.threads();
    return available();
  }

  template <class M>
  static std::size_t connectivity_size(M const& mesh) {
    if constexpr (requires { mesh.connectivity_size(); }) {
      return mesh.connectivity_size();
    } else {
      std::size_t size = 0;
      auto const add = [&]<class T, std::size_t N>(std::vector<std::array<T, N>> const& elements) {
        size += N * elements.size();
      };
      std::apply([&](auto const&... elements) { (add(elements), ...); }, mesh.tables);
      return size;
    }
  }

  void share(int count, FunctionRef<void(int)> task) {
    Loop loop{.task = task, .count = count, .room = std::min(count_, count) - 1};
    start(loop.room);
    in_loop_ = true;
    {
      std::lock_guard const lock(mutex_);
      loop_ = &loop;
    }
    wake_.notify_all();
    loop.work();
    {
      std::unique_lock lock(mutex_);
      loop_ = nullptr;  // who has not woken up yet sleeps on
      idle_.wait(lock, [&] { return working_ == 0; });
    }
    in_loop_ = false;
    loop.thrown.rethrow();
  }
  /// The helpers of a loop, or as many as the system gives.
  void start(int helpers) {
    try {
      for (; started_ < helpers; ++started_)
        helpers_[static_cast<std::size_t>(started_)] = std::thread([this] { help(); });
    } catch (std::system_error const&) {
      count_ = started_ + 1;
    }
  }
  void help() {
    current() = this;
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [&] { return stopping_ || (loop_ != nullptr && loop_->room > 0); });
      if (stopping_) return;
      Loop& loop = *loop_;
      --loop.room;
      ++working_;
      lock.unlock();
      loop.work();
      lock.lock();
      if (--working_ == 0) idle_.notify_one();
    }
  }

  int count_;
  bool is_outermost_;
  std::atomic<bool> in_loop_{false};
  std::array<std::thread, most_threads - 1> helpers_;
  int started_ = 0;   // of them
  std::mutex mutex_;  // of what follows
  std::condition_variable wake_, idle_;
  Loop* loop_ = nullptr;
  int working_ = 0;  // helpers
  bool stopping_ = false;
};

namespace detail {

/// [0, n) cut into parts for the threads of the host. How many there are follows from these: what is computed must not.
template <std::integral I>
class HostParts {
 public:
  /// None is shorter than `few`, which is worth a thread, where there are several.
  explicit HostParts(I n, I few = 16384) : n_(n) {
    if (int const threads = HostThreads::now(); threads > 1)
      count_ =
          static_cast<int>(std::clamp<I>(n / std::max<I>(few, 1), 1, static_cast<I>(4 * threads)));
  }
  int count() const { return count_; }
  I size() const { return n_; }
  I first(int part) const {
    return static_cast<I>(static_cast<std::uint64_t>(n_) * static_cast<unsigned>(part) /
                          static_cast<unsigned>(count_));
  }
  /// f(first, last, part) for each part. Throws what a loop over [0, n) would have thrown first.
  void operator()(FunctionRef<void(I, I, int)> f) const {
    if (count_ == 1) return f(I{0}, n_, 0);
    HostThreads::run(count_, [&](int part) { f(first(part), first(part + 1), part); });
  }

 private:
  I n_;
  int count_ = 1;
};

/// Whether there are threads enough for an algorithm that does up to twice the work of a serial one to share it.
inline bool has_many_host_threads() { return HostThreads::now() > 3; }

/// How many elements of so many nodes are worth a thread.
constexpr Index few_elements(std::size_t nodes) { return 32768 / static_cast<Index>(nodes); }

/// f(i) for each i < n, on the threads of the host.
template <class F>
void for_each_on_host(Index n, Index few, F const& f) {
  HostParts(n, few)([&](Index first, Index last, int) {
    for (Index i = first; i < last; ++i) f(i);
  });
}

}  // namespace detail

}  // namespace pliant

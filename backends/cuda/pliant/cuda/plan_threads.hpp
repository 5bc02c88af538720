#pragma once

#include <pliant/config.hpp>

// What plans of patches are made by: the threads of a block, or one thread of a host, which need not meet.
namespace pliant::detail {

/// A host's thread as planners see it.
struct OneThread {
  PLIANT_HOST_DEVICE int first() const { return 0; }
  PLIANT_HOST_DEVICE static constexpr int stride() { return 1; }
  PLIANT_HOST_DEVICE void meet() const {}
  PLIANT_HOST_DEVICE bool any(bool value) const { return value; }  // of all threads, which meet
  /// The sum of what the threads before this one have, and of what all have into `all`. All threads have met then.
  template <class U>
  PLIANT_HOST_DEVICE U sum_before(U own, U& all) const {
    all = own;
    return 0;
  }
};

/// Calls f(i) for each i < n, in the calling threads together.
template <class Threads, class F>
PLIANT_HOST_DEVICE void share_out(Threads const& threads, int n, F const& f) {
  for (int i = threads.first(); i < n; i += threads.stride()) f(i);
}

PLIANT_HOST_DEVICE int add_shared(int& to, int value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(&to, value);
#else
  int const before = to;
  to += value;
  return before;
#endif
}
PLIANT_HOST_DEVICE void lower_shared(int& to, int value) {
#if defined(__CUDA_ARCH__)
  atomicMin(&to, value);
#else
  if (value < to) to = value;
#endif
}
PLIANT_HOST_DEVICE void raise_shared(int& to, int value) {
#if defined(__CUDA_ARCH__)
  atomicMax(&to, value);
#else
  if (value > to) to = value;
#endif
}
PLIANT_HOST_DEVICE int exchange_shared(int& to, int value) {
#if defined(__CUDA_ARCH__)
  return atomicExch(&to, value);
#else
  int const before = to;
  to = value;
  return before;
#endif
}
/// Puts `value` where `expected` is; returns what was there.
PLIANT_HOST_DEVICE int replace_shared(int& to, int expected, int value) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(&to, expected, value);
#else
  int const before = to;
  if (before == expected) to = value;
  return before;
#endif
}

/// The place of a key in an open table of 2^k keys, where it is put if it is new; negative where the table is full.
PLIANT_HOST_DEVICE int find_or_insert(int* keys, int mask, int key) {
  constexpr int none = -1;
  unsigned at = static_cast<unsigned>(key) * 0x9E3779B1u >> 8;
  for (int tries = 0; tries <= mask; ++tries, ++at) {
    int const place = static_cast<int>(at & static_cast<unsigned>(mask));
    int const there = replace_shared(keys[place], none, key);
    if (there == none || there == key) return place;
  }
  return -1;
}

/// Memory that planners take pieces of, one behind the other; without an address it only adds them up.
class PlanMemory {
 public:
  PLIANT_HOST_DEVICE explicit PlanMemory(void* memory = nullptr)
      : base_(static_cast<char*>(memory)) {}
  template <class U>
  PLIANT_HOST_DEVICE U* take(int count) {
    used_ = (used_ + 3) / 4 * 4;
    char* const address = base_ == nullptr ? nullptr : base_ + used_;
    used_ += count * static_cast<int>(sizeof(U));
    if (used_ > most_) most_ = used_;
    return reinterpret_cast<U*>(address);
  }
  PLIANT_HOST_DEVICE int used() const { return used_; }
  /// What was taken since so much was in use is free again.
  PLIANT_HOST_DEVICE PlanMemory& from(int used) {
    used_ = used;
    return *this;
  }
  /// The most that was in use, bytes.
  PLIANT_HOST_DEVICE int most() const { return most_; }

 private:
  char* base_;
  int used_ = 0, most_ = 0;
};

}  // namespace pliant::detail

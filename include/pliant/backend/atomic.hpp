#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

#include <pliant/config.hpp>

// Numbers that several calls of a loop change at once, on the host and on a device. None of these orders other accesses: what
// a loop has changed is there when it has ended.
namespace pliant::detail {

template <class U>
PLIANT_HOST_DEVICE U atomic_load(U& number) {
#ifdef __CUDA_ARCH__
  return *static_cast<U volatile*>(&number);
#else
  return std::atomic_ref(number).load(std::memory_order_relaxed);
#endif
}
template <class U>
PLIANT_HOST_DEVICE void atomic_store(U& number, std::type_identity_t<U> value) {
#ifdef __CUDA_ARCH__
  *static_cast<U volatile*>(&number) = value;
#else
  std::atomic_ref(number).store(value, std::memory_order_relaxed);
#endif
}
/// Stores a value that other calls store too, and that stays: a device asks its caches first, since stores to one place wait for
/// each other there.
template <class U>
PLIANT_HOST_DEVICE void atomic_set(U& number, std::type_identity_t<U> value) {
#ifdef __CUDA_ARCH__
  if (number != value) *static_cast<U volatile*>(&number) = value;
#else
  std::atomic_ref(number).store(value, std::memory_order_relaxed);
#endif
}
/// The number, or what it was before: a device asks its caches, so that calls that ask for one number do not wait for each other.
template <class U>
PLIANT_HOST_DEVICE U atomic_peek(U& number) {
#ifdef __CUDA_ARCH__
  return number;
#else
  return std::atomic_ref(number).load(std::memory_order_relaxed);
#endif
}
/// Gives what the number was.
PLIANT_HOST_DEVICE Index atomic_add(Index& number, Index by) {
#ifdef __CUDA_ARCH__
  return atomicAdd(&number, by);
#else
  return std::atomic_ref(number).fetch_add(by, std::memory_order_relaxed);
#endif
}
PLIANT_HOST_DEVICE std::uint32_t atomic_add(std::uint32_t& number, std::uint32_t by) {
#ifdef __CUDA_ARCH__
  return atomicAdd(&number, by);
#else
  return std::atomic_ref(number).fetch_add(by, std::memory_order_relaxed);
#endif
}
/// The same for 64 bits.
PLIANT_HOST_DEVICE std::uint64_t atomic_add(std::uint64_t& number, std::uint64_t by) {
#ifdef __CUDA_ARCH__
  using Word = unsigned long long;
  static_assert(sizeof(Word) == sizeof(std::uint64_t));
  return atomicAdd(reinterpret_cast<Word*>(&number), static_cast<Word>(by));
#else
  return std::atomic_ref(number).fetch_add(by, std::memory_order_relaxed);
#endif
}
template <class U>
PLIANT_HOST_DEVICE void atomic_min(U& number, std::type_identity_t<U> value) {
#ifdef __CUDA_ARCH__
  atomicMin(&number, value);
#else
  std::atomic_ref const own(number);
  U seen = own.load(std::memory_order_relaxed);
  while (value < seen && !own.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}
/// number = value where it is `seen` still; otherwise seen = number, and false.
PLIANT_HOST_DEVICE bool atomic_exchange(Index& number, Index& seen, Index value) {
#ifdef __CUDA_ARCH__
  Index const before = atomicCAS(&number, seen, value);
  bool const done = before == seen;
  seen = before;
  return done;
#else
  return std::atomic_ref(number).compare_exchange_strong(seen, value, std::memory_order_relaxed);
#endif
}

}  // namespace pliant::detail

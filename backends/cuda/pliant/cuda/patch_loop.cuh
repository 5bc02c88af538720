#pragma once

#include <cstddef>

#include <pliant/config.hpp>

// What keeps the registers of a loop over the elements of a patch few: one more than a bound allows costs a
// resident block, or goes through memory.
namespace pliant::detail {

/// What a thread knows of its loop over the elements of a patch, in one register: the tag of the
/// element that comes next, whether one has acted, and how many rounds are left.
class PatchLoop {
 public:
  /// Of one of a block's threads, which share a patch's elements.
  __device__ PatchLoop(Index elements, Index thread, Index threads)
      : bits_(static_cast<unsigned>((elements - thread + threads - 1) / threads) * round) {}
  __device__ bool has_rounds() const { return bits_ >= round; }
  __device__ bool acted() const { return bits_ & act; }
  __device__ Tag tag() const { return static_cast<Tag>(bits_); }
  __device__ void set_tag(Tag tag) { bits_ |= tag; }
  /// The tag is 0 then.
  __device__ void next_round(bool acts) {
    bits_ = ((bits_ - round) & ~(act - 1)) | (acts ? act : 0);
  }

 private:
  static constexpr unsigned act = 1u << 8, round = 1u << 9;
  unsigned bits_;
};

/// A kernel argument that the compiler takes for another one at each call: otherwise it keeps what it
/// computes from the laws of all groups in registers throughout a loop over elements.
template <bool Opaque, class Kernel>
__device__ __forceinline__ Kernel const& opaque(Kernel const& kernel) {
  if constexpr (!Opaque) return kernel;
  std::ptrdiff_t zero;
  asm volatile("mov.u64 %0, 0;" : "=l"(zero));
  auto const address = reinterpret_cast<char const*>(&kernel) + zero;
  __builtin_assume(address != nullptr);
  return *reinterpret_cast<Kernel const*>(address);
}

}  // namespace pliant::detail

#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include <pliant/math/functions.hpp>

namespace pliant {

/// The widest SIMD register of the target, bytes.
#if defined(__AVX512F__)
inline constexpr int simd_bytes = 64;
#elif defined(__AVX__)
inline constexpr int simd_bytes = 32;
#else
inline constexpr int simd_bytes = 16;
#endif

/// Lanes of a pack: one register, no more. Compilers keep packs of several registers in memory.
template <class T>
inline constexpr int pack_lanes = simd_bytes / int{sizeof(T)};

// Sums of products become one instruction, as g++ has it without being asked.
#if defined(__clang__)
#define PLIANT_CONTRACT _Pragma("clang fp contract(fast)")
#else
#define PLIANT_CONTRACT
#endif

/// One number of several elements side by side, in the lanes of a SIMD register.
template <class T, int Lanes = pack_lanes<T>>
struct Pack {
  static constexpr int lanes = Lanes;
  typedef T Register __attribute__((vector_size(sizeof(T) * Lanes)));
  using Integer = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  typedef Integer Mask __attribute__((vector_size(sizeof(T) * Lanes)));

  Register v;

  Pack() = default;
  PLIANT_HOST_DEVICE Pack(Register r) : v(r) {}
  template <Arithmetic A>
  PLIANT_HOST_DEVICE Pack(A a) : v(static_cast<T>(a) - Register{}) {}

  PLIANT_HOST_DEVICE T operator[](int lane) const { return v[lane]; }

  friend PLIANT_HOST_DEVICE Pack operator+(Pack a, Pack b) {
    PLIANT_CONTRACT
    return {a.v + b.v};
  }
  friend PLIANT_HOST_DEVICE Pack operator-(Pack a, Pack b) {
    PLIANT_CONTRACT
    return {a.v - b.v};
  }
  friend PLIANT_HOST_DEVICE Pack operator*(Pack a, Pack b) {
    PLIANT_CONTRACT
    return {a.v * b.v};
  }
  friend PLIANT_HOST_DEVICE Pack operator/(Pack a, Pack b) { return {a.v / b.v}; }
  friend PLIANT_HOST_DEVICE Pack operator-(Pack a) { return {-a.v}; }
  friend PLIANT_HOST_DEVICE Pack& operator+=(Pack& a, Pack b) { return a = a + b; }
  friend PLIANT_HOST_DEVICE Pack& operator-=(Pack& a, Pack b) { return a = a - b; }
  friend PLIANT_HOST_DEVICE Pack& operator*=(Pack& a, Pack b) { return a = a * b; }
  friend PLIANT_HOST_DEVICE Mask operator<(Pack a, Pack b) { return a.v < b.v; }
  friend PLIANT_HOST_DEVICE Mask operator==(Pack a, Pack b) { return a.v == b.v; }
};

#undef PLIANT_CONTRACT

template <class T, int L>
struct BuiltinScalar<Pack<T, L>> {
  using type = T;
};

template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> select(typename Pack<T, L>::Mask mask, Pack<T, L> a, Pack<T, L> b) {
  return {mask ? a.v : b.v};
}

template <class T, int L>
PLIANT_HOST_DEVICE bool any_less(Pack<T, L> a, Pack<T, L> b) {
  auto const mask = a < b;
  typename Pack<T, L>::Integer some = 0;
  for (int l = 0; l < L; ++l) some |= mask[l];
  return some != 0;
}

template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> abs(Pack<T, L> const& x) {
  return select(x < Pack<T, L>(0), -x, x);
}

}  // namespace pliant

#include <pliant/openmp/pack_functions.hpp>

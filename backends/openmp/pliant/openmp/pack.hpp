#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include <Eigen/Core>

#include <pliant/math/functions.hpp>

// Vectors passed by value are always inlined; their calling convention does not matter.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace pliant {

/// The widest SIMD register of the target, bytes.
#if defined(__AVX512F__)
inline constexpr int simd_bytes = 64;
#elif defined(__AVX__)
inline constexpr int simd_bytes = 32;
#else
inline constexpr int simd_bytes = 16;
#endif

/// Lanes of a pack: a full register, and at least the four values of a padded node.
template <class T>
inline constexpr int pack_lanes = simd_bytes / int{sizeof(T)} < 4 ? 4 : simd_bytes / int{sizeof(T)};

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

  friend PLIANT_HOST_DEVICE Pack operator+(Pack a, Pack b) { return {a.v + b.v}; }
  friend PLIANT_HOST_DEVICE Pack operator-(Pack a, Pack b) { return {a.v - b.v}; }
  friend PLIANT_HOST_DEVICE Pack operator*(Pack a, Pack b) { return {a.v * b.v}; }
  friend PLIANT_HOST_DEVICE Pack operator/(Pack a, Pack b) { return {a.v / b.v}; }
  friend PLIANT_HOST_DEVICE Pack operator-(Pack a) { return {-a.v}; }
  friend PLIANT_HOST_DEVICE Pack& operator+=(Pack& a, Pack b) { return a = a + b; }
  friend PLIANT_HOST_DEVICE Pack& operator-=(Pack& a, Pack b) { return a = a - b; }
  friend PLIANT_HOST_DEVICE Pack& operator*=(Pack& a, Pack b) { return a = a * b; }
  friend PLIANT_HOST_DEVICE Mask operator<(Pack a, Pack b) { return a.v < b.v; }
};

template <class T, int L>
struct BuiltinScalar<Pack<T, L>> {
  using type = T;
};

template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> select(typename Pack<T, L>::Mask mask, Pack<T, L> a, Pack<T, L> b) {
  return {mask ? a.v : b.v};
}

namespace detail {
// Eigen holds vectorised elementary functions; it sees the lanes as an array.
template <class T, int L, class F>
PLIANT_HOST_DEVICE Pack<T, L> lanewise(Pack<T, L> const& x, F const& f) {
  Eigen::Array<T, L, 1> in, out;
  __builtin_memcpy(in.data(), &x.v, sizeof(x.v));
  out = f(in);
  Pack<T, L> y;
  __builtin_memcpy(&y.v, out.data(), sizeof(y.v));
  return y;
}
}  // namespace detail

template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> sqrt(Pack<T, L> const& x) {
  return detail::lanewise(x, [](auto const& a) { return a.sqrt(); });
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> log(Pack<T, L> const& x) {
  return detail::lanewise(x, [](auto const& a) { return a.log(); });
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> log1p(Pack<T, L> const& x) {
  return detail::lanewise(x, [](auto const& a) { return a.log1p(); });
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> exp(Pack<T, L> const& x) {
  return detail::lanewise(x, [](auto const& a) { return a.exp(); });
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> expm1(Pack<T, L> const& x) {
  return detail::lanewise(x, [](auto const& a) { return a.expm1(); });
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> abs(Pack<T, L> const& x) {
  return select(x < Pack<T, L>(0), -x, x);
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> cbrt(Pack<T, L> const& x) {
  // A step of Newton's method takes away what the logarithm and the exponential round.
  using P = Pack<T, L>;
  P const size = abs(x), root = exp(log(size) / P(3));
  P const better = root - (root - size / (root * root)) / P(3);
  return select(P(0) < size, select(x < P(0), -better, better), x);
}

}  // namespace pliant

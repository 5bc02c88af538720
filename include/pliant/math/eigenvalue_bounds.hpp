#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include <pliant/math/functions.hpp>
#include <pliant/math/matrix.hpp>

// Upper bounds of the largest |eigenvalue| of the symmetric matrix of an element.
namespace pliant::detail {

/// f(i, j) for the places of the upper half of a matrix. Small matrices stay in a GPU's registers: loops are unrolled there.
template <int N, class F>
PLIANT_HOST_DEVICE void for_each_upper_place(F const& f) {
#if defined(__CUDA_ARCH__)
  // Each loop as often: those inside are unrolled first.
  constexpr int together = N <= 9 ? N : 1;
#pragma unroll(together)
  for (int i = 0; i < N; ++i)
#pragma unroll(together)
    for (int j = 0; j < N; ++j)
      if (i <= j) f(i, j);
#else
  for (int i = 0; i < N; ++i)
    for (int j = i; j < N; ++j) f(i, j);
#endif
}

/// The Frobenius norm ‖A⁴‖^(1/4) of a symmetric matrix, computed from A scaled to norm one: within a factor N^(1/8).
template <class S, int N>
PLIANT_HOST_DEVICE S bound_by_powers(Tensor<S, N> a) {
  using T = builtin_scalar<S>;
  S largest = S(0);
  for (int i = 0; i < N; ++i) {
    S row = S(0);
    for (int j = 0; j < N; ++j) row = row + abs(a(i, j));
    largest = max(largest, row);
  }
  a = (S(1) / max(largest, S(std::numeric_limits<T>::min()))) * a;
  auto const of_square = [](Tensor<S, N> const& matrix, int i, int j) PLIANT_INLINE {
    S sum = matrix(i, 0) * matrix(j, 0);
    for (int k = 1; k < N; ++k) sum = sum + matrix(i, k) * matrix(j, k);
    return sum;
  };
  Tensor<S, N> square;
  for_each_upper_place<N>([&](int i, int j)
                              PLIANT_INLINE { square(i, j) = square(j, i) = of_square(a, i, j); });
  S fourth = S(0);  // ‖A⁴‖²
  for_each_upper_place<N>([&](int i, int j) PLIANT_INLINE {
    S const entry = of_square(square, i, j);
    fourth = fourth + T(i == j ? 1 : 2) * entry * entry;
  });
  return largest * sqrt(sqrt(sqrt(fourth)));
}

/// A symmetric tridiagonal matrix.
template <class S, int K>
struct Tridiagonal {
  Vector<S, K> diagonal,
      off;  // off[i] stands between i and i + 1; the last one is not the matrix's

  /// An upper bound of the largest eigenvalue, too large by at most 2⁻¹² of Gershgorin's interval.
  PLIANT_HOST_DEVICE S upper_bound() const {
    S low = diagonal[0], high = diagonal[0];
    for (int i = 0; i < K; ++i) {
      S radius = S(0);
      if (i > 0) radius = radius + abs(off[i - 1]);
      if (i + 1 < K) radius = radius + abs(off[i]);
      low = min(low, diagonal[i] - radius);
      high = max(high, diagonal[i] + radius);
    }
    for (int halving = 0; halving < 12; ++halving) {
      S const middle = (low + high) / 2;
      auto const is_above = S(0) < least_pivot(middle);
      high = select(is_above, middle, high);
      low = select(is_above, low, middle);
    }
    return high;
  }

 private:
  /// The least pivot of x − T, or a negative number where one is negative: positive where x is above all eigenvalues.
  PLIANT_HOST_DEVICE S least_pivot(S const& x) const {
    S pivot = x - diagonal[0], least = pivot;
    for (int i = 1; i < K; ++i) {
      pivot = x - diagonal[i] - off[i - 1] * off[i - 1] / select(S(0) < pivot, pivot, S(1));
      least = min(least, pivot);
    }
    return least;
  }
};

/// Numbers with a normal distribution, nearly: the same ones always.
template <int N>
constexpr Vector<double, N> random_vector() {
  Vector<double, N> numbers{};
  std::uint64_t state = 1;
  for (int i = 0; i < N; ++i) {
    numbers[i] = -6;
    for (int k = 0; k < 12; ++k) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      numbers[i] += static_cast<double>(state >> 11) * 0x1p-53;
    }
  }
  return numbers;
}

/// From products apply(x) = A x alone, without the matrix: Lanczos' largest and least eigenvalues after `steps` products,
/// each moved outwards by 0.1 of what lies between them. Of all vectors to begin with, at most a share of
/// 1.648 √N exp(−√0.1 (2 · steps − 1)) finds less than the eigenvalue (Kuczyński and Woźniakowski 1992, theorem 4.2): 1e-9.
template <class S, int N, class Apply>
PLIANT_HOST_DEVICE S bound_by_products(Apply const& apply) {
  using T = builtin_scalar<S>;
  constexpr int steps = 38;
  static_assert(N > steps && N <= 100);
  constexpr T margin = T(0.1);
  constexpr auto start = random_vector<N>();
  S const least = S(std::numeric_limits<T>::min());
  Vector<S, N> q, before = Vector<S, N>::zero();
  for (int i = 0; i < N; ++i) q[i] = S(T(start[i]));
  q = (S(1) / norm(q)) * q;
  S size =
      S(1);  // the largest entry of the first product: squares over it keep within the range of T
  Tridiagonal<S, steps> found;
  for (int k = 0; k < steps; ++k) {
    Vector<S, N> product = apply(q);
    if (k == 0) {
      size = least;
      for (int i = 0; i < N; ++i) size = max(size, abs(product[i]));
    }
    product = (S(1) / size) * product;
    if (k > 0) product = product - found.off[k - 1] * before;
    found.diagonal[k] = dot(product, q);
    product = product - found.diagonal[k] * q;
    found.off[k] = norm(product);
    before = q;
    q = (S(1) / max(found.off[k], least)) * product;
  }
  S const high = found.upper_bound();
  S sum = S(0);  // not finite where something is not
  for (int k = 0; k < steps; ++k) {
    sum = sum + found.diagonal[k] + found.off[k];
    found.diagonal[k] = -found.diagonal[k];
  }
  S const low = -found.upper_bound();
  S const apart = margin * (high - low);
  return size * (max(high, -low) + apart + S(0) * sum);
}

}  // namespace pliant::detail

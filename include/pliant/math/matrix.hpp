#pragma once

#include <pliant/math/functions.hpp>

namespace pliant {

/// A small dense matrix on the stack: plain storage that a compiler can keep in registers, on the
/// host and on the device. (Eigen serves the host interface; its products cost registers in kernels.)
template <class T, int Rows, int Columns = 1>
struct Matrix {
  T entries[Rows][Columns];  // (rows, columns)

  PLIANT_HOST_DEVICE constexpr T& operator()(int i, int j) { return entries[i][j]; }
  PLIANT_HOST_DEVICE constexpr T const& operator()(int i, int j) const { return entries[i][j]; }
  PLIANT_HOST_DEVICE constexpr T& operator[](int i)
    requires(Columns == 1)
  {
    return entries[i][0];
  }
  PLIANT_HOST_DEVICE constexpr T const& operator[](int i) const
    requires(Columns == 1)
  {
    return entries[i][0];
  }

  PLIANT_HOST_DEVICE static constexpr Matrix zero() {
    Matrix m;
    for (int i = 0; i < Rows; ++i)
      for (int j = 0; j < Columns; ++j) m(i, j) = T(0);
    return m;
  }
  PLIANT_HOST_DEVICE static constexpr Matrix identity() {
    Matrix m = zero();
    for (int i = 0; i < Rows; ++i) m(i, i) = T(1);
    return m;
  }
};

template <class T, int N>
using Vector = Matrix<T, N, 1>;

/// A second-order tensor in N dimensions.
template <class T, int N>
using Tensor = Matrix<T, N, N>;

// Each entry is written once: a copy that is then changed would often stay one, in memory.
template <class T, int R, int C>
PLIANT_HOST_DEVICE constexpr Matrix<T, R, C> operator+(Matrix<T, R, C> const& a,
                                                       Matrix<T, R, C> const& b) {
  Matrix<T, R, C> sum;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) sum(i, j) = a(i, j) + b(i, j);
  return sum;
}
template <class T, int R, int C>
PLIANT_HOST_DEVICE constexpr Matrix<T, R, C> operator-(Matrix<T, R, C> const& a,
                                                       Matrix<T, R, C> const& b) {
  Matrix<T, R, C> difference;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) difference(i, j) = a(i, j) - b(i, j);
  return difference;
}
template <class S, class T, int R, int C>
  requires std::constructible_from<T, S const&>
PLIANT_HOST_DEVICE constexpr Matrix<T, R, C> operator*(S const& s, Matrix<T, R, C> const& a) {
  Matrix<T, R, C> product;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) product(i, j) = s * a(i, j);
  return product;
}
template <class T, int R, int K, int C>
PLIANT_HOST_DEVICE constexpr Matrix<T, R, C> operator*(Matrix<T, R, K> const& a,
                                                       Matrix<T, K, C> const& b) {
  Matrix<T, R, C> product;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) {
      T sum = a(i, 0) * b(0, j);
      for (int k = 1; k < K; ++k) sum = sum + a(i, k) * b(k, j);
      product(i, j) = sum;
    }
  return product;
}

template <class T, int R, int C>
PLIANT_HOST_DEVICE constexpr Matrix<T, C, R> transpose(Matrix<T, R, C> const& a) {
  Matrix<T, C, R> t;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) t(j, i) = a(i, j);
  return t;
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr T trace(Tensor<T, N> const& a) {
  T sum = a(0, 0);
  for (int i = 1; i < N; ++i) sum = sum + a(i, i);
  return sum;
}
/// The double contraction a:b (the scalar product of vectors).
template <class T, int R, int C>
PLIANT_HOST_DEVICE constexpr T dot(Matrix<T, R, C> const& a, Matrix<T, R, C> const& b) {
  T sum = T(0);
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) sum = sum + a(i, j) * b(i, j);
  return sum;
}
template <class T>
PLIANT_HOST_DEVICE constexpr Vector<T, 3> cross(Vector<T, 3> const& a, Vector<T, 3> const& b) {
  return {{{a[1] * b[2] - a[2] * b[1]}, {a[2] * b[0] - a[0] * b[2]}, {a[0] * b[1] - a[1] * b[0]}}};
}
/// The area vector that the tangents of a surface span, one per column.
template <class T>
PLIANT_HOST_DEVICE constexpr Vector<T, 2> area_of(Matrix<T, 2, 1> const& t) {
  return {{{t(1, 0)}, {-t(0, 0)}}};
}
template <class T>
PLIANT_HOST_DEVICE constexpr Vector<T, 3> area_of(Matrix<T, 3, 2> const& t) {
  return cross(Vector<T, 3>{{{t(0, 0)}, {t(1, 0)}, {t(2, 0)}}},
               Vector<T, 3>{{{t(0, 1)}, {t(1, 1)}, {t(2, 1)}}});
}
template <class T, int R, int C>
PLIANT_HOST_DEVICE T norm(Matrix<T, R, C> const& a) {
  return sqrt(dot(a, a));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Tensor<T, N> symmetric_part(Tensor<T, N> const& a) {
  Tensor<T, N> s;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) s(i, j) = (a(i, j) + a(j, i)) / T(2);
  return s;
}

/// The cofactor matrix, det(a) a⁻ᵀ.
template <class T>
PLIANT_HOST_DEVICE constexpr Tensor<T, 2> cofactor(Tensor<T, 2> const& a) {
  return {{{a(1, 1), -a(1, 0)}, {-a(0, 1), a(0, 0)}}};
}
template <class T>
PLIANT_HOST_DEVICE constexpr Tensor<T, 3> cofactor(Tensor<T, 3> const& a) {
  Tensor<T, 3> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      int const i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c(i, j) = a(i1, j1) * a(i2, j2) - a(i1, j2) * a(i2, j1);
    }
  return c;
}
template <class T>
PLIANT_HOST_DEVICE constexpr T determinant(Tensor<T, 2> const& a) {
  return a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
}
template <class T>
PLIANT_HOST_DEVICE constexpr T determinant(Tensor<T, 3> const& a) {
  Tensor<T, 3> const c = cofactor(a);
  return a(0, 0) * c(0, 0) + a(0, 1) * c(0, 1) + a(0, 2) * c(0, 2);
}

/// cof(I + h) − I, without rounding the identity away.
template <class T>
PLIANT_HOST_DEVICE constexpr Tensor<T, 2> cofactor_less_identity(Tensor<T, 2> const& h) {
  return cofactor(h);
}
template <class T>
PLIANT_HOST_DEVICE constexpr Tensor<T, 3> cofactor_less_identity(Tensor<T, 3> const& h) {
  Tensor<T, 3> c = cofactor(h) - transpose(h);
  for (int i = 0; i < 3; ++i) c(i, i) = c(i, i) + trace(h);
  return c;
}
/// det(I + h) − 1 − tr h, the part beyond first order.
template <class T>
PLIANT_HOST_DEVICE constexpr T determinant_beyond_trace(Tensor<T, 2> const& h) {
  return determinant(h);
}
template <class T>
PLIANT_HOST_DEVICE constexpr T determinant_beyond_trace(Tensor<T, 3> const& h) {
  Tensor<T, 3> const c = cofactor(h);
  return trace(c) + (h(0, 0) * c(0, 0) + h(0, 1) * c(0, 1) + h(0, 2) * c(0, 2));
}
/// det(I + h) − 1, without rounding the one away.
template <class T, int N>
PLIANT_HOST_DEVICE constexpr T determinant_less_one(Tensor<T, N> const& h) {
  return trace(h) + determinant_beyond_trace(h);
}

}  // namespace pliant

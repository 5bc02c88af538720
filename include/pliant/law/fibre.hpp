#pragma once

#include <pliant/law/law.hpp>

namespace pliant::detail {

/// v / |v|, and 0 where v is.
template <class S>
PLIANT_HOST_DEVICE Vector<S, 3> normalised(Vector<S, 3> const& v) {
  S const size = norm(v);
  return select(S(0) < size, S(1), S(0)) / select(S(0) < size, size, S(1)) * v;
}

/// The structure tensor d I + (1 − 3d) a⊗a of fibres along v that spread by d; 0 where v is.
template <class T, class S>
PLIANT_HOST_DEVICE Tensor<S, 3> structure(T const& d, Vector<S, 3> const& v) {
  auto const a = normalised(v);
  Tensor<S, 3> H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H(i, j) = (1 - 3 * d) * (a[i] * a[j]);
  for (int i = 0; i < 3; ++i) H(i, i) = H(i, i) + d * dot(a, a);
  return H;
}

}  // namespace pliant::detail

#pragma once

#include <limits>

#include <pliant/math/functions.hpp>

namespace pliant::detail {

PLIANT_HOST_DEVICE bool is_finite(double x) { return abs(x) <= std::numeric_limits<double>::max(); }
/// NaN must propagate through a maximum: what is not finite counts as infinite.
PLIANT_HOST_DEVICE double infinite_if_not_finite(double x) {
  return is_finite(x) ? x : std::numeric_limits<double>::infinity();
}
/// Work that is not finite is not booked.
PLIANT_HOST_DEVICE double zero_if_not_finite(double x) { return is_finite(x) ? x : 0.0; }

/// The values of an array, for maximum and sum.
template <class T>
struct ValueAt {
  T const* data;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return infinite_if_not_finite(static_cast<double>(data[i]));
  }
};

template <class T>
struct FillValue {
  T* values;
  T value;
  PLIANT_HOST_DEVICE void operator()(Index i) const { values[i] = value; }
};

}  // namespace pliant::detail

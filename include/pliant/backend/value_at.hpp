#pragma once

#include <limits>

#include <pliant/math/functions.hpp>

namespace pliant::detail {

/// NaN must propagate through a maximum: what is not finite counts as infinite.
PLIANT_HOST_DEVICE double infinite_if_not_finite(double x) {
  return x <= std::numeric_limits<double>::max() ? x : std::numeric_limits<double>::infinity();
}

/// The values of an array, for maximum and sum.
template <class T>
struct ValueAt {
  T const* data;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return infinite_if_not_finite(static_cast<double>(data[i]));
  }
};

}  // namespace pliant::detail

#pragma once

#include <pliant/config.hpp>

namespace pliant {

/// base^exponent, exponent ≥ 0.
PLIANT_HOST_DEVICE constexpr int power(int base, int exponent) {
  int product = 1;
  for (int k = 0; k < exponent; ++k) product *= base;
  return product;
}

}  // namespace pliant

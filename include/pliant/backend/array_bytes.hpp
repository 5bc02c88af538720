#pragma once

#include <cstddef>
#include <limits>

#include <pliant/error.hpp>

namespace pliant::detail {

/// The bytes that an array of so many values takes. Throws Error where no number holds them.
template <class U>
std::size_t array_bytes(std::size_t count) {
  if (count > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(U))
    throw Error("an array of ", count, " values of ", sizeof(U),
                " bytes is larger than memory; make a smaller mesh");
  return count * sizeof(U);
}

}  // namespace pliant::detail

#pragma once

#include <stdexcept>
#include <string>

namespace pliant {

/// The one exception of the library. Its message says what was wrong, where, and what to do; the
/// object that was being changed stays as it was.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace pliant

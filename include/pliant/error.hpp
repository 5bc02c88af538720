#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

namespace pliant {

/// The one exception of the library. Its message says what was wrong, where, and what to do; the
/// object that was being changed stays as it was.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {
/// A number as messages show it, however small.
inline std::string text(double x) {
  char characters[32];
  std::snprintf(characters, sizeof characters, "%g", x);
  return characters;
}
}  // namespace detail

}  // namespace pliant

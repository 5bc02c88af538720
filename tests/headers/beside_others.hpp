#pragma once

#include <atomic>

// Operators of the library leave those of other classes alone.
namespace pliant {

inline bool is_between(std::atomic<int> const& number) { return 0 < number && number < 2; }
inline double with_a_half(std::atomic<int> const& number) {
  return (number + 0.5) * (0.5 - number) / (number - 0.5);
}

}  // namespace pliant

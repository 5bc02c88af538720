#pragma once

#include <array>
#include <cstddef>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Sums in a backend's memory that are added to one after the other and read all at once, so that the host waits for a device
/// once and not for each. They begin at zero.
template <std::size_t N, Backend B>
class Sums {
 public:
  explicit Sums(B const& backend) : sums_(zeros<double>(backend, N)) {}

  [[nodiscard]] double* data() { return sums_.data(); }
  /// All of them; waits for what is queued.
  [[nodiscard]] std::array<double, N> read() const {
    std::array<double, N> sums;
    sums_.download(sums);
    return sums;
  }

 private:
  typename B::template Array<double> sums_;
};

}  // namespace pliant

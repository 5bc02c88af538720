#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/config.hpp>

namespace pliant::detail {

/// A number for each entry of a list, by which loops tell entries that were seen: those with the number of the last `begin`.
template <Backend B>
class Stamps {
 public:
  /// None of so many entries was seen.
  void begin(B const& backend, std::size_t count) {
    if (array_.size() < count) {
      array_ = zeros<Index>(backend, array_.size() == 0 ? count : count + count / 2);
      now_ = 0;
    }
    ++now_;
  }
  [[nodiscard]] Index* data() { return array_.data(); }
  [[nodiscard]] Index now() const { return now_; }

 private:
  typename B::template Array<Index> array_;
  Index now_ = 0;
};

}  // namespace pliant::detail

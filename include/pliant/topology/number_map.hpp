#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

/// Other numbers for the entries of a list, some of which go. What stays keeps its order.
class NumberMap {
 public:
  /// All keep their numbers.
  NumberMap() = default;
  /// Those before `first` keep theirs; entry first + k gets others[k], or −1: it goes.
  NumberMap(Index first, std::vector<Index> others) : first_(first), others_(std::move(others)) {}

  /// Whether it is known without a look that all keep their numbers.
  [[nodiscard]] bool keeps_all() const { return first_ == all; }
  [[nodiscard]] Index first() const { return first_; }
  /// Of the entries from `first` on.
  [[nodiscard]] std::vector<Index> const& others() const { return others_; }
  [[nodiscard]] Index operator[](Index number) const {
    return number < first_ ? number : others_[static_cast<std::size_t>(number - first_)];
  }
  /// The numbers before, of what stays.
  [[nodiscard]] NumberMap inverse() const {
    NumberMap back(first_, {});
    for (std::size_t k = 0; k < others_.size(); ++k)
      if (others_[k] >= 0) back.others_.push_back(first_ + static_cast<Index>(k));
    return back;
  }

 private:
  static constexpr Index all = std::numeric_limits<Index>::max();

  Index first_ = all;
  std::vector<Index> others_;
};

}  // namespace pliant

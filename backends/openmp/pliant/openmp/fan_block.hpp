#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/openmp/host_fan_splitter.hpp>

namespace pliant::detail {

/// The fans of a block of tetrahedra, in terms of the block alone: they stay when elements and nodes get other numbers.
struct FanBlock {
  std::vector<unsigned char> sizes;  // of the fans, in elements
  std::vector<Index> elements;       // of the block, in the order of fans
  std::vector<Index> corners;        // of each fan: places 4 · element + a of its 3 + size nodes

  /// Of `count` elements with the nodes rows[4 · count].
  FanBlock(Index const* rows, Index count, HostFanSplitter& splitter) {
    elements.reserve(static_cast<std::size_t>(count));
    Index const parts = std::max<Index>(1, (count + size / 2) / size);
    for (Index part = 0; part < parts; ++part) {
      auto const begin = static_cast<Index>(std::int64_t{count} * part / parts);
      auto const end = static_cast<Index>(std::int64_t{count} * (part + 1) / parts);
      splitter.split(rows + std::ptrdiff_t{4} * begin, end - begin,
                     [&](int const* ends, int const* ring, int const* members, int fan_size) {
                       for (int k = 0; k < 2; ++k) corners.push_back(4 * begin + ends[k]);
                       for (int k = 0; k <= fan_size; ++k) corners.push_back(4 * begin + ring[k]);
                       for (int k = 0; k < fan_size; ++k) elements.push_back(begin + members[k]);
                       sizes.push_back(static_cast<unsigned char>(fan_size));
                     });
    }
  }

  /// Elements: fans do not go beyond so many, and longer blocks are cut. From 2048 to 240 forces take the same time, within 2%.
  static constexpr Index size = 240;
};

/// All blocks of a table of tetrahedra.
class FanBlocks {
 public:
  FanBlocks() = default;
  /// Of elements with the nodes connectivity[4 · elements]; blocks that stay are those `before` has.
  FanBlocks(Index const* connectivity, Index elements, ElementBlocks const& cut,
            FanBlocks const* before)
      : first_(cut.first) {
    if (first_.empty())
      for (Index e = 0; e < elements + FanBlock::size; e += FanBlock::size)
        first_.push_back(std::min(e, elements));
    blocks_.resize(first_.size() - 1);
    HostParts const parts(count(), few);
    parts([&](Index from, Index to, int) {
      HostFanSplitter splitter;
      for (Index b = from; b < to; ++b) {
        auto const k = static_cast<std::size_t>(b);
        if (before != nullptr && !cut.stays.empty() && cut.stays[k] != 0)
          blocks_[k] = before->blocks_[k];
        else
          blocks_[k] = std::make_shared<FanBlock>(connectivity + std::ptrdiff_t{4} * first_[k],
                                                  first_[k + 1] - first_[k], splitter);
      }
    });
  }

  Index count() const { return static_cast<Index>(blocks_.size()); }
  /// visit(block, number of its first element) for the blocks that have elements in [from, to).
  template <class Visit>
  void for_each_in(Index from, Index to, Visit const& visit) const {
    auto b = std::ranges::upper_bound(first_, from) - first_.begin() - 1;
    for (auto k = static_cast<std::size_t>(b); k < blocks_.size() && first_[k] < to; ++k)
      if (first_[k + 1] > first_[k]) visit(*blocks_[k], first_[k]);
  }

 private:
  static constexpr Index few = 16;  // worth a thread

  std::vector<Index> first_;  // (blocks + 1), elements
  std::vector<std::shared_ptr<FanBlock const>> blocks_;
};

}  // namespace pliant::detail

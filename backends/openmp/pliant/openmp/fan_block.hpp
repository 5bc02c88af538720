#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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
  std::vector<Index> nodes;          // places 4 · element + a, as corners first have them
  std::vector<Index> corners;        // of each fan: numbers in `nodes` of its 3 + size nodes

  /// Of `count` elements with the nodes rows[4 · count].
  FanBlock(Index const* rows, Index count, HostFanSplitter& splitter) {
    elements.reserve(static_cast<std::size_t>(count));
    Index const parts = std::max<Index>(1, (count + size / 2) / size);
    for (Index part = 0; part < parts; ++part) {
      auto const begin = static_cast<Index>(std::int64_t{count} * part / parts);
      auto const end = static_cast<Index>(std::int64_t{count} * (part + 1) / parts);
      std::vector<Index> numbers(4 * static_cast<std::size_t>(end - begin), -1);
      auto const add_corner = [&](int place) {
        Index& number = numbers[static_cast<std::size_t>(place)];
        if (number < 0) {
          number = static_cast<Index>(nodes.size());
          nodes.push_back(4 * begin + place);
        }
        corners.push_back(number);
      };
      splitter.split(rows + std::ptrdiff_t{4} * begin, end - begin,
                     [&](int const* ends, int const* ring, int const* members, int fan_size) {
                       for (int k = 0; k < 2; ++k) add_corner(ends[k]);
                       for (int k = 0; k <= fan_size; ++k) add_corner(ring[k]);
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
  /// Of so many elements; rows_of(e): the nodes of element e, behind which are those of the others of its block. Blocks that
  /// stay are those `before` has.
  template <class RowsOf>
  FanBlocks(RowsOf const& rows_of, Index elements, ElementBlocks const& cut,
            FanBlocks const* before)
      : first_(cut.first) {
    if (first_.empty())
      for (Index e = 0; e < elements + FanBlock::size; e += FanBlock::size)
        first_.push_back(std::min(e, elements));
    auto const count = static_cast<Index>(first_.size()) - 1;
    groups_.resize(at((count + of_group - 1) / of_group));
    HostParts const parts(static_cast<Index>(groups_.size()), few);
    parts([&](Index from, Index to, int) {
      HostFanSplitter splitter;
      for (Index g = from; g < to; ++g) {
        Index const begin = of_group * g, end = std::min(begin + of_group, count);
        auto const stays = [&](Index b) {
          return before != nullptr && !cut.stays.empty() && cut.stays[at(b)] != 0;
        };
        Index staying = 0;
        for (Index b = begin; b < end; ++b) staying += stays(b) ? 1 : 0;
        if (staying == of_group) {
          groups_[at(g)] = before->groups_[at(g)];
          continue;
        }
        auto const group = std::make_shared<Group>();
        for (Index b = begin; b < end; ++b)
          (*group)[at(b - begin)] =
              stays(b) ? before->block(b)
                       : made(rows_of, first_[at(b)], first_[at(b + 1)] - first_[at(b)], splitter);
        groups_[at(g)] = group;
      }
    });
  }

  /// visit(block, number of its first element) for the blocks that have elements in [from, to).
  template <class Visit>
  void for_each_in(Index from, Index to, Visit const& visit) const {
    auto b = static_cast<Index>(std::ranges::upper_bound(first_, from) - first_.begin()) - 1;
    for (; at(b) + 1 < first_.size() && first_[at(b)] < to; ++b)
      if (first_[at(b + 1)] > first_[at(b)]) visit(*block(b), first_[at(b)]);
  }

 private:
  static constexpr Index of_group = 16, few = 1;  // blocks; groups that are worth a thread
  /// Consecutive blocks, which tables share at once where all of them stay.
  using Group = std::array<std::shared_ptr<FanBlock const>, of_group>;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  std::shared_ptr<FanBlock const> const& block(Index b) const {
    return (*groups_[at(b / of_group)])[at(b % of_group)];
  }

  template <class RowsOf>
  static std::shared_ptr<FanBlock const> made(RowsOf const& rows_of, Index first, Index count,
                                              HostFanSplitter& splitter) {
    Index const* const rows = count == 0 ? nullptr : rows_of(first);
    return std::make_shared<FanBlock>(rows, count, splitter);
  }

  std::vector<Index> first_;  // (blocks + 1), elements
  std::vector<std::shared_ptr<Group const>> groups_;
};

}  // namespace pliant::detail

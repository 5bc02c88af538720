#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/patch_ranges.hpp>
#include <pliant/config.hpp>

namespace pliant::detail {

/// Finds PatchRanges::of_run.
struct PatchOfRun {
  Index const* first;
  Index patches;
  Index* of_run;

  PLIANT_HOST_DEVICE void operator()(Index run) const {
    Index const e = PatchRanges::run * run;
    Index low = 0, high = patches;  // the patch is in [low, high), and not empty
    while (high - low > 1) {
      Index const middle = low + (high - low) / 2;
      (first[middle] <= e ? low : high) = middle;
    }
    of_run[run] = low;
  }
};

/// How a table is cut into patches. Where it has blocks, no patch has elements of two chapters of them: those of a chapter
/// whose blocks all stay in a change stay as well.
class PatchCuts {
 public:
  PatchCuts() = default;
  /// `size`: how many elements a patch has at most.
  PatchCuts(Index elements, Index size, ElementBlocks const& blocks = {})
      : size_(size), blocks_of_chapter_(size < 2048 ? 16 : 8) {
    if (blocks.first.empty()) {
      for (Index e = 0; e < elements; e += size) first_.push_back(std::min(e + size, elements));
      return;
    }
    auto const count = blocks.first.size() - 1;
    first_.reserve(static_cast<std::size_t>(elements / size) + count / blocks_of_chapter_ + 2);
    of_chapter_.reserve(count / blocks_of_chapter_ + 2);
    of_chapter_.push_back(0);
    for (std::size_t b = 0; b < count; b += blocks_of_chapter_) {
      Index const begin = blocks.first[b],
                  own = blocks.first[std::min(b + blocks_of_chapter_, count)] - begin,
                  parts = own / size + (own % size != 0);
      // Patch k ends with own k / parts, rounded down, without a division for each.
      Index const each = parts > 0 ? own / parts : 0, rest = parts > 0 ? own % parts : 0;
      for (Index k = 0, end = begin, over = 0; k < parts; ++k) {
        end += each;
        over += rest;
        if (over >= parts) {
          over -= parts;
          ++end;
        }
        first_.push_back(end);
      }
      of_chapter_.push_back(static_cast<Index>(first_.size()) - 1);
    }
  }

  Index size() const { return size_; }
  Index count() const { return static_cast<Index>(first_.size()) - 1; }
  /// (patches + 1), elements.
  std::vector<Index> const& first() const { return first_; }
  Index first(Index patch) const { return first_[static_cast<std::size_t>(patch)]; }

  /// By the patch, that which had the same elements of the same nodes before a change; −1: none had.
  std::vector<Index> known_from(PatchCuts const& before, ElementBlocks const& blocks) const {
    std::vector<Index> known(static_cast<std::size_t>(count()), -1);
    if (!blocks.some_stay() || before.size_ != size_ ||
        before.of_chapter_.size() != of_chapter_.size())
      return known;
    for (std::size_t c = 0; c + 1 < of_chapter_.size(); ++c) {
      auto const from = blocks_of_chapter_ * c,
                 to = std::min(from + blocks_of_chapter_, blocks.stays.size());
      if (std::ranges::count(std::span(blocks.stays).subspan(from, to - from), 0) > 0) continue;
      for (Index p = of_chapter_[c]; p < of_chapter_[c + 1]; ++p)
        known[static_cast<std::size_t>(p)] = before.of_chapter_[c] + p - of_chapter_[c];
    }
    return known;
  }

 private:
  Index size_ = 1;
  /// Of 240 elements each in a first mesh, 16 are five patches of 768 or ten of 384, and 8 are one of 2048.
  std::size_t blocks_of_chapter_ = 16;
  std::vector<Index> first_{0}, of_chapter_;  // elements; patches
};

/// The same on the host, for loops there.
class HostPatches : public PatchCuts {
 public:
  HostPatches() = default;
  HostPatches(Index elements, Index size, ElementBlocks const& blocks = {})
      : PatchCuts(elements, size, blocks),
        of_run_(static_cast<std::size_t>(PatchRanges::runs(elements))) {
    for (Index patch = 0, run = 0; run < static_cast<Index>(of_run_.size()); ++run) {
      while (first(patch + 1) <= PatchRanges::run * run) ++patch;
      of_run_[static_cast<std::size_t>(run)] = patch;
    }
  }
  PatchRanges ranges() const { return {first().data(), of_run_.data(), size()}; }

 private:
  std::vector<Index> of_run_;
};

}  // namespace pliant::detail

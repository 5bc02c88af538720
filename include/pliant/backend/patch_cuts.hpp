#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
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

/// How a table is cut into patches. Where it has blocks, no patch has elements of two chapters of them, and what a chapter is cut
/// into follows from the sizes of its blocks. Patches keep to where they began and ended in a first mesh, as long as that takes no
/// more of them, so that those stay of which all blocks stay; else a chapter's share it evenly.
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
    FirstCuts const first_cuts(static_cast<Index>(blocks_of_chapter_) * ElementBlocks::usual, size);
    for (std::size_t b = 0; b < count; b += blocks_of_chapter_) {
      cut_chapter(blocks.first, b, std::min(b + blocks_of_chapter_, count), first_cuts);
      of_chapter_.push_back(this->count());
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
      if (std::ranges::count(std::span(blocks.stays).subspan(from, to - from), 0) == 0)
        for (Index p = of_chapter_[c]; p < of_chapter_[c + 1]; ++p)
          known[static_cast<std::size_t>(p)] = before.of_chapter_[c] + p - of_chapter_[c];
      else
        find_known(before, blocks, c, from, known);
    }
    return known;
  }

 private:
  /// Where the patches of a chapter end in a first mesh: in which block, counted from the chapter's first, and behind how many of
  /// its elements.
  class FirstCuts {
   public:
    FirstCuts(Index elements, Index size) {
      Index const parts = parts_of(elements, size);
      for (Index k = 1; k < parts; ++k) {
        auto const end = static_cast<Index>(std::int64_t{elements} * k / parts);
        ends_.push_back(
            {static_cast<std::size_t>(end / ElementBlocks::usual), end % ElementBlocks::usual});
      }
    }

    /// visit(end) of the patches of some blocks, which have other sizes now.
    template <class Visit>
    void visit_ends(std::vector<Index> const& first, std::size_t block, std::size_t end,
                    Visit const& visit) const {
      for (auto const& [of_chapter, elements] : ends_) {
        auto const b = block + of_chapter;
        if (b >= end) break;
        visit(std::min(first[b] + elements, first[b + 1]));
      }
      visit(first[end]);
    }

   private:
    struct End {
      std::size_t block;
      Index elements;
    };
    std::vector<End> ends_;  // but for the last
  };

  static Index parts_of(Index elements, Index size) {
    if (elements <= size) return elements > 0 ? 1 : 0;  // most, which takes no division
    return elements / size + (elements % size != 0);
  }

  /// Known patches of a chapter, of which not all blocks stay. `block`: its first.
  void find_known(PatchCuts const& before, ElementBlocks const& blocks, std::size_t chapter,
                  std::size_t block, std::vector<Index>& known) const {
    Index then = before.of_chapter_[chapter];
    Index const last = before.of_chapter_[chapter + 1];
    for (Index p = of_chapter_[chapter]; p < of_chapter_[chapter + 1]; ++p) {
      while (blocks.first[block + 1] <= first(p)) ++block;
      auto staying = block;
      while (blocks.first[staying] < first(p + 1) && blocks.stays[staying] != 0) ++staying;
      if (blocks.first[staying] < first(p + 1)) continue;
      Index const begin = first(p) - blocks.first[block] + blocks.first_before[block];
      while (then < last && before.first(then) < begin) ++then;
      if (then < last && before.first(then) == begin &&
          before.first(then + 1) - begin == first(p + 1) - first(p))
        known[static_cast<std::size_t>(p)] = then;
    }
  }
  void cut_chapter(std::vector<Index> const& first, std::size_t block, std::size_t end,
                   FirstCuts const& first_cuts) {
    Index parts = 0, from = first[block];
    first_cuts.visit_ends(first, block, end, [&](Index to) {
      parts += parts_of(to - std::exchange(from, to), size_);
    });
    if (parts > parts_of(first[end] - first[block], size_)) return cut(first[end]);
    first_cuts.visit_ends(first, block, end, [&](Index to) { cut(to); });
  }
  /// Cuts what is behind the last patch, up to an element, into patches that share it evenly.
  void cut(Index to) {
    Index const begin = first_.back(), own = to - begin, parts = parts_of(own, size_);
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
  }

  Index size_ = 1;
  /// Of `ElementBlocks::usual` elements each, 16 are five patches of 768 or ten of 384, and 8 are one of 2048.
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

#include <algorithm>
#include <numeric>

#include <pliant/backend/patch_cuts.hpp>

#include "support/catch.hpp"

namespace pliant::test::patch_cuts_test {

using detail::HostPatches;
using detail::PatchCuts;

/// Blocks of as many elements each, all of which stay, but those of a list that get other elements.
struct Change {
  ElementBlocks before, after;
};
Change change(std::vector<Index> const& sizes, std::vector<std::pair<std::size_t, Index>> others) {
  auto const first_of = [](std::vector<Index> const& of) {
    std::vector<Index> first{0};
    for (Index n : of) first.push_back(first.back() + n);
    return first;
  };
  Change made;
  made.before.first = first_of(sizes);
  auto changed = sizes;
  made.after.stays.assign(sizes.size(), 1);
  for (auto const& [block, size] : others) {
    changed[block] = size;
    made.after.stays[block] = 0;
  }
  made.after.first = first_of(changed);
  made.after.first_before = made.before.first;
  return made;
}

TEST_CASE("a table without blocks has patches of one size, but for the last", "[backend]") {
  CHECK(PatchCuts(0, 8).first() == std::vector<Index>{0});
  CHECK(PatchCuts(8, 8).first() == std::vector<Index>{0, 8});
  CHECK(PatchCuts(17, 8).first() == std::vector<Index>{0, 8, 16, 17});
}

/// How many elements patches have.
std::vector<Index> sizes_of(PatchCuts const& cuts) {
  std::vector<Index> sizes;
  for (Index p = 0; p < cuts.count(); ++p) sizes.push_back(cuts.first(p + 1) - cuts.first(p));
  return sizes;
}

TEST_CASE("patches of a first mesh are full, and end with chapters of blocks", "[backend]") {
  auto const sizes =
      sizes_of({38 * 240 + 5, 768, change({std::vector<Index>(38, 240)}, {}).before});
  CHECK(sizes == std::vector<Index>{768, 768, 768, 768, 768, 768, 768, 768, 768, 768, 768, 672});
}

TEST_CASE("patches behind a change are where they were, if that takes no more", "[backend]") {
  // Sixteen blocks of 3840 elements in all are five patches, of which the third begins in block 6, behind 96 elements.
  auto const sizes_behind = [](std::vector<std::pair<std::size_t, Index>> others, Index more) {
    auto const [before, after] = change(std::vector<Index>(16, 240), std::move(others));
    return sizes_of({3840 + more, 768, after});
  };
  CHECK(sizes_behind({{1, 247}}, 7) == std::vector<Index>{387, 388, 768, 768, 768, 768});
  CHECK(sizes_behind({{6, 247}}, 7) == std::vector<Index>{768, 768, 387, 388, 768, 768});
  CHECK(sizes_behind({{15, 1920}}, 1680) ==
        std::vector<Index>{768, 768, 768, 768, 612, 612, 612, 612});
  CHECK(sizes_behind({{0, 241}, {1, 239}}, 0) == std::vector<Index>(5, 768));
  // A block with less than belongs to the patch before.
  CHECK(sizes_behind({{6, 90}}, -150) == std::vector<Index>{768, 762, 624, 768, 768});
  // In the first and the last of five, each of which would become two: seven, for which six have room.
  CHECK(sizes_behind({{1, 247}, {15, 247}}, 14) ==
        std::vector<Index>{642, 642, 643, 642, 642, 643});
}

TEST_CASE("patches of which all blocks stay are known from before", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(40, 240), {{3, 247}});
  PatchCuts const first(40 * 240, 768, before), then(40 * 240 + 7, 768, after);

  // The first begins block 3, and the second, which is two now, goes on with it.
  CHECK(then.known_from(first, after) ==
        std::vector<Index>{-1, -1, -1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  for (std::size_t p = 3; p < 14; ++p) CHECK(then.first()[p] == first.first()[p - 1] + 7);
  CHECK(then.known_from(PatchCuts(40 * 240, 384, before), after) ==
        std::vector<Index>(14, -1));  // of another size
  CHECK(then.known_from(PatchCuts(40 * 240, 768), after) == std::vector<Index>(14, -1));
  CHECK(then.known_from(first, {after.first, {}, {}}) == std::vector<Index>(14, -1));
}

TEST_CASE("patches with other elements of blocks that stay are not known", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(16, 240), {{9, 247}, {15, 247}});
  PatchCuts const first(3840, 768, before), then(3854, 768, after);  // cut anew
  CHECK(then.known_from(first, after) == std::vector<Index>(6, -1));

  auto const [full, gone] = change(std::vector<Index>(16, 240), {{5, 0}});
  // The second has lost a block in its midst, the others are where they were.
  CHECK(PatchCuts(3600, 768, gone).known_from({3840, 768, full}, gone) ==
        std::vector<Index>{0, -1, 2, 3, 4});
}

TEST_CASE("large patches stay where blocks of others beside them change", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(40, 240), {{9, 254}});
  PatchCuts const first(40 * 240, 2048, before), then(40 * 240 + 14, 2048, after);
  CHECK(first.first() == std::vector<Index>{0, 1920, 3840, 5760, 7680, 9600});
  CHECK(then.first() == std::vector<Index>{0, 1920, 3854, 5774, 7694, 9614});
  CHECK(then.known_from(first, after) == std::vector<Index>{0, -1, 2, 3, 4});

  auto const [full, grown] = change(std::vector<Index>(40, 240), {{9, 400}});
  PatchCuts const more(40 * 240 + 160, 2048, grown);
  CHECK(more.first() == std::vector<Index>{0, 1920, 2960, 4000, 5920, 7840, 9760});
  CHECK(more.known_from({40 * 240, 2048, full}, grown) == std::vector<Index>{0, -1, -1, 2, 3, 4});
}

TEST_CASE("every element finds its patch", "[backend]") {
  // Chapters of no element, of one, of many, and patches shorter than a run.
  std::vector<Index> sizes(80, 0);
  sizes[16] = 1;
  sizes[33] = 500;
  sizes[48] = 70;
  for (Index size : {5, 31, 64}) {
    INFO("patches of " << size);
    auto const blocks = change(sizes, {}).before;
    HostPatches const patches(571, size, blocks);
    auto const ranges = patches.ranges();
    for (Index p = 0, e = 0; p < patches.count(); ++p) {
      CHECK(patches.first(p) < patches.first(p + 1));
      CHECK(patches.first(p + 1) - patches.first(p) <= size);
      for (; e < patches.first(p + 1); ++e) CHECK(ranges.patch_of(e) == p);
    }
    CHECK(patches.first(patches.count()) == 571);
    for (Index run = 0; run < PatchRanges::runs(571); ++run) {
      std::vector<Index> of_run(static_cast<std::size_t>(run) + 1);
      detail::PatchOfRun{patches.first().data(), patches.count(), of_run.data()}(run);
      CHECK(of_run.back() == ranges.of_run[run]);
    }
  }
}

}  // namespace pliant::test::patch_cuts_test

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

TEST_CASE("patches end with chapters of blocks, and share them evenly", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(40, 240), {{3, 247}, {39, 0}});
  PatchCuts const first(40 * 240, 768, before), then(40 * 240 - 233, 768, after);

  // Sixteen blocks have 3840 elements, the last eight have 1920.
  CHECK(first.first() == std::vector<Index>{0, 768, 1536, 2304, 3072, 3840, 4608, 5376, 6144, 6912,
                                            7680, 8320, 8960, 9600});
  CHECK(then.first() == std::vector<Index>{0, 641, 1282, 1923, 2564, 3205, 3847, 4615, 5383, 6151,
                                           6919, 7687, 8247, 8807, 9367});
  CHECK(std::ranges::max(then.first()) == 40 * 240 - 233);
}

TEST_CASE("patches of chapters of which all blocks stay are known from before", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(40, 240), {{3, 247}});
  PatchCuts const first(40 * 240, 768, before), then(40 * 240 + 7, 768, after);

  CHECK(then.known_from(first, after) ==
        std::vector<Index>{-1, -1, -1, -1, -1, -1, 5, 6, 7, 8, 9, 10, 11, 12});
  for (std::size_t p = 6; p < 14; ++p) CHECK(then.first()[p] == first.first()[p - 1] + 7);
  CHECK(then.known_from(PatchCuts(40 * 240, 384, before), after) ==
        std::vector<Index>(14, -1));  // of another size
  CHECK(then.known_from(PatchCuts(40 * 240, 768), after) == std::vector<Index>(14, -1));
  CHECK(then.known_from(first, {after.first, {}, {}}) == std::vector<Index>(14, -1));
}

TEST_CASE("large patches stay where blocks of others beside them change", "[backend]") {
  auto const [before, after] = change(std::vector<Index>(40, 240), {{9, 254}});
  PatchCuts const first(40 * 240, 2048, before), then(40 * 240 + 14, 2048, after);
  CHECK(first.first() == std::vector<Index>{0, 1920, 3840, 5760, 7680, 9600});
  CHECK(then.first() == std::vector<Index>{0, 1920, 3854, 5774, 7694, 9614});
  CHECK(then.known_from(first, after) == std::vector<Index>{0, -1, 2, 3, 4});
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

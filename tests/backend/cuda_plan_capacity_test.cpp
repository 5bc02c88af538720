#include <algorithm>

#include <pliant/cuda/fan_plan.hpp>
#include <pliant/cuda/patch_plan.hpp>
#include <pliant/cuda/plan_capacity.hpp>

#include "support/catch.hpp"

namespace pliant::test::cuda_plan_capacity_test {

using detail::PatchCounts;

/// The capacity of patches behind so many changes of many of them, which need the same behind each.
template <class Planner>
PatchCounts capacity_after(int changes, PatchCounts needed, int patch_size) {
  if (Planner::usual(patch_size).fans == 0) needed.fans = 0;
  PatchCounts capacity = detail::in_fours(needed), changed{};
  for (int change = 0; change < changes; ++change) {
    auto const guess = detail::capacity_of_many<Planner>(capacity, changed, patch_size);
    CHECK(detail::holds(guess, needed));
    capacity = detail::may_keep(guess, needed) ? guess : detail::in_fours(needed);
    changed = needed;
  }
  return capacity;
}

TEST_CASE("patches of which many change again and again have little room to spare",
          "[cuda][patch plan]") {
  for (int diagonals : {20, 40, 90}) {
    INFO(diagonals << " diagonals are needed");
    PatchCounts const needed{300, diagonals, 190, 1700};
    for (int changes : {1, 2, 3, 20}) {
      for (auto const& capacity : {capacity_after<detail::FanPlanner>(changes, needed, 768),
                                   capacity_after<detail::PatchPlanner<4>>(changes, needed, 768)}) {
        CHECK(capacity.nodes <= 320);
        CHECK(capacity.slots <= 1804);
        CHECK(capacity.diagonals <= 2 * std::max(diagonals, 32));
      }
    }
  }
}

TEST_CASE(
    "patches that were refined need what they did the last time, whatever they needed between",
    "[cuda][patch plan]") {
  PatchCounts const refined{340, 60, 190, 1900}, coarsened{300, 40, 190, 1700};
  detail::LastNeeds needs;
  auto const guess = [&](bool leaves_fewer) {
    return detail::capacity_of_many<detail::FanPlanner>(coarsened, needs.behind(leaves_fewer), 768);
  };
  auto const usual = guess(false);
  CHECK(usual.slots == guess(true).slots);
  // Much was needed once.
  needs.note(false, {500, 90, 200, 2200});
  CHECK(guess(true).slots == usual.slots);
  needs.note(false, refined);
  needs.note(true, coarsened);
  CHECK(detail::may_keep(guess(false), refined));
  CHECK(detail::may_keep(guess(true), coarsened));
  CHECK_FALSE(detail::may_keep(guess(false), coarsened));
  CHECK_FALSE(detail::may_keep(guess(true), refined));
}

TEST_CASE("patches have more room where they needed more", "[cuda][patch plan]") {
  PatchCounts const before{300, 40, 190, 1700};
  auto const guess = [&](PatchCounts const& changed) {
    return detail::capacity_of_many<detail::FanPlanner>(before, changed, 768);
  };
  CHECK(detail::holds(guess({}), detail::FanPlanner::most(768)));
  PatchCounts const changed{310, 70, 200, 1800};
  CHECK(detail::holds(guess(changed), changed));
  CHECK(guess(changed).slots < 1900);
  CHECK_FALSE(detail::may_keep(guess(changed), before));
}

}  // namespace pliant::test::cuda_plan_capacity_test

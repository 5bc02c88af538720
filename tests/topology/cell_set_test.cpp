#include <limits>
#include <set>
#include <vector>

#include <pliant/topology/cell_set.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

// Sets of cells, against std::set.
namespace pliant::test {
namespace {

void check_same(CellSet const& set, std::set<Index> const& expected, Index end) {
  REQUIRE(set.size() == expected.size());
  REQUIRE(std::vector<Index>(set.begin(), set.end()) ==
          std::vector<Index>(expected.begin(), expected.end()));
  Index place = 0;
  for (Index c = 0; c < end; ++c) {
    REQUIRE(set.rank(c) == place);
    REQUIRE(set.contains(c) == expected.contains(c));
    if (!expected.contains(c)) continue;
    REQUIRE(set[static_cast<std::size_t>(place)] == c);
    if (place % 17 == 0) REQUIRE(*set.from(static_cast<std::size_t>(place)) == c);
    ++place;
  }
  REQUIRE(set.rank(end + 5000) == place);
  REQUIRE(set.from(expected.size()) == set.end());
}

/// The cells that stay keep their order, from `first_moved` on without gaps.
std::vector<Index> without_gaps(std::set<Index> const& gone, Index first_moved, Index end) {
  std::vector<Index> now(static_cast<std::size_t>(end), -1);
  Index next = first_moved;
  for (Index c = first_moved; c < end; ++c)
    if (!gone.contains(c)) now[static_cast<std::size_t>(c)] = next++;
  return now;
}

TEST_CASE("sets of cells after random changes are those of a list", "[topology]") {
  Random random(5);
  Index end = 700;
  CellSet set = CellSet::range(100, end);
  std::set<Index> expected;
  for (Index c = 100; c < end; ++c) expected.insert(c);
  check_same(set, expected, end);
  for (int i = 0; i < 200; ++i) {
    bool const moves = i % 3 == 2;
    Index const first_moved = 300;
    std::vector<Index> leaving, arriving;
    std::set<Index> gone;
    for (Index const c : expected)
      if (random.below(9) == 0) {
        leaving.push_back(c);
        if (moves && c >= first_moved) gone.insert(c);
      }
    for (Index const c : leaving) expected.erase(c);
    auto const now = without_gaps(gone, first_moved, end);
    if (moves) {
      std::set<Index> moved;
      for (Index const c : expected)
        moved.insert(c < first_moved ? c : now[static_cast<std::size_t>(c)]);
      expected = moved;
      end -= static_cast<Index>(gone.size());
    }
    for (auto n = static_cast<Index>(random.below(60)); n > 0; --n) {
      arriving.push_back(end);
      expected.insert(end);
      end += 1 + static_cast<Index>(random.below(12));
    }
    set = set.changed(
        leaving, moves ? first_moved : std::numeric_limits<Index>::max(),
        [&](Index c) { return now[static_cast<std::size_t>(c)]; }, arriving);
    check_same(set, expected, end);
  }
}

TEST_CASE("an empty set of cells has none", "[topology]") {
  check_same(CellSet(), {}, 3);
  check_same(CellSet::range(5, 5), {}, 9);
}

}  // namespace
}  // namespace pliant::test

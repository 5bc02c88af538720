#include <pliant/topology/transfer.hpp>

#include "support/catch.hpp"
#include "support/fields.hpp"

namespace pliant::test::transfer_test {

/// Two elements of 6 nodes, of which the second is split in four; two of another type, which stay.
inline Transfer<2> transfer() {
  return Transfer<2>(
      {.old_nodes = 6,
       .new_nodes = {{6, {{1, 0.5}, {2, 0.5}}},
                     {7, {{2, 0.5}, {5, 0.5}}},
                     {8, {{1, 0.5}, {6, 0.5}}}},
       .old_elements = {2, 2},
       .origins = {{{0, -1}, {1, 0}, {1, 1}, {1, 2}, {1, 3}}, {{1, -1}, {0, -1}}},
       .divided = {
           {{1, 2}, {{1, 6}, {6, 2}}}, {{5, 2}, {{5, 7}, {7, 2}}}, {{1, 6}, {{1, 8}, {8, 6}}}}});
}

TEST_CASE("values per node go over as weighted sums", "[topology]") {
  auto const t = transfer();
  CHECK(t.old_nodes() == 6);
  CHECK(t.nodes() == 9);
  std::vector<double> const numbers{0, 1, 3, 0, 0, 9};
  CHECK(t.carry_nodes(numbers) == std::vector<double>{0, 1, 3, 0, 0, 9, 2, 6, 1.5});
  std::vector<float> const floats{0, 1, 3, 0, 0, 9};
  CHECK(t.carry_nodes(floats) == std::vector<float>{0, 1, 3, 0, 0, 9, 2, 6, 1.5f});
  std::vector<Point<2>> points(6);
  points[1] = {1, -4};
  points[2] = {3, 4};
  auto const carried = t.carry_nodes(points);
  REQUIRE(carried.size() == 9);
  CHECK(carried[2] == Point<2>{3, 4});
  CHECK(carried[6] == Point<2>{2, 0});
  CHECK(carried[8] == Point<2>{1.5, -2});
}

TEST_CASE("values per element go over from their ancestors", "[topology]") {
  auto const t = transfer();
  CHECK(t.carry_elements(std::vector<int>{7, 8}) == std::vector<int>{7, 8, 8, 8, 8});
  CHECK(t.carry_elements(std::vector<int>{7, 8}, 1) == std::vector<int>{8, 7});
  CHECK(t.carry_elements(std::vector<double>{1, 2, 3, 4, 5, 6}, 0, 3) ==
        std::vector<double>{1, 2, 3, 4, 5, 6, 4, 5, 6, 4, 5, 6, 4, 5, 6});
  CHECK(t.carry_elements(std::vector<double>{1, 2, 3, 4, 5, 6}, 1, 3) ==
        std::vector<double>{4, 5, 6, 1, 2, 3});
}

TEST_CASE("facets give way to their parts, in order along them", "[topology]") {
  auto const t = transfer();
  using Facets = std::vector<Facet<2>>;
  CHECK(t.carry_facets({{0, 1}, {1, 2}, {5, 2}}) ==
        Facets{{0, 1}, {1, 8}, {8, 6}, {6, 2}, {5, 7}, {7, 2}});
  CHECK(t.carry_facets({{2, 1}}) == Facets{{2, 6}, {6, 8}, {8, 1}});
  CHECK(t.carry_facets({}) == Facets{});
}

TEST_CASE("facets of solids give way to four parts that run round as they do", "[topology]") {
  using Facets = std::vector<Facet<3>>;
  Transfer<3> const solid(
      {.old_nodes = 7,
       .new_nodes = {{7, {{0, 0.5}, {1, 0.5}}},
                     {8, {{1, 0.5}, {2, 0.5}}},
                     {9, {{2, 0.5}, {0, 0.5}}}},
       .old_elements = {1},
       .origins = {{{0, -1}}},
       .divided = {{{0, 1, 2}, {{0, 7, 9}, {1, 8, 7}, {2, 9, 8}, {8, 9, 7}}},
                   {{3, 4, 5, 6}, {{3, 0, 1, 2}, {4, 7, 1, 0}, {5, 8, 1, 7}, {6, 2, 1, 8}}}}});
  CHECK(solid.carry_facets({{0, 1, 3}}) == Facets{{0, 1, 3}});
  CHECK(solid.carry_facets({{1, 2, 0}}) == Facets{{1, 8, 7}, {2, 9, 8}, {0, 7, 9}, {8, 9, 7}});
  CHECK(solid.carry_facets({{1, 0, 2}}) == Facets{{1, 7, 8}, {0, 9, 7}, {2, 8, 9}, {8, 7, 9}});
  CHECK(solid.carry_facets({{4, 3, 6, 5}}) ==
        Facets{{4, 0, 1, 7}, {3, 2, 1, 0}, {6, 8, 1, 2}, {5, 7, 1, 8}});
}

/// Nodes 2 and 4 go; elements 0 to 3 of six become one.
inline Transfer<2> merging() {
  return Transfer<2>(
      {.old_nodes = 6,
       .renumbered = {1, {1, -1, 2, -1, 3}},
       .gone = {{2, {{0, 0.25}, {5, 0.75}}}, {4, {{1, 0.5}, {3, 0.5}}}},
       .old_elements = {6},
       .origins = {{{4, -1}, {0, Transfer<2>::Origin::merged, 0}, {5, -1}}},
       .families = {{{{0, 0}, {0, 1}, {0, 2}, {0, 3}}, {{0, 1}}, {0.125, 0.125, 0.25, 0.5}}},
       .merged = {{{0, 5}, {{0, 2}, {2, 5}}}}});
}

TEST_CASE("values at nodes that go are left behind, and sums handed on", "[topology]") {
  auto const t = merging();
  CHECK(t.nodes() == 4);
  CHECK(t.carry_nodes(std::vector<double>{10, 11, 12, 13, 14, 15}) ==
        std::vector<double>{10, 11, 13, 15});
  CHECK(t.carry_sums(std::vector<double>{1, 2, 4, 8, 16, 32}) ==
        std::vector<double>{2, 10, 16, 35});
  CHECK(transfer().carry_sums(std::vector<double>{1, 2, 3, 4, 5, 6}) ==
        std::vector<double>{1, 2, 3, 4, 5, 6, 0, 0, 0});
  CHECK_THROWS_AS(t.carry_sums(std::vector<double>(4)), Error);
}

TEST_CASE("nodes that stay are told their numbers before", "[topology]") {
  auto const t = merging();
  CHECK(t.renumbers());
  CHECK(t.staying_nodes() == 4);
  CHECK(t.first_renumbered() == 2);
  auto const old = t.old_numbers();
  Index const wanted[] = {0, 1, 3, 5};
  for (Index node = 0; node < 4; ++node) {
    CHECK(old[node] == wanted[node]);
    CHECK(t.renumbered(old[node]) == node);
  }
  CHECK(!transfer().renumbers());
  CHECK(transfer().old_numbers().keeps_all());
  CHECK(transfer().old_numbers()[5] == 5);
}

TEST_CASE("merged elements have their children's mean by volume, or their most frequent value",
          "[topology]") {
  auto const t = merging();
  CHECK(t.carry_elements(std::vector<double>{1, 2, 3, 4, 5, 6}) ==
        std::vector<double>{5, 3.125, 6});
  CHECK(t.carry_elements(std::vector<double>{0.1, 0.1, 0.1, 0.1, 5, 6}) ==
        std::vector<double>{5, 0.1, 6});
  CHECK(t.carry_elements(std::vector<int>{7, 8, 9, 8, 1, 2}) == std::vector<int>{1, 8, 2});
  CHECK(t.carry_elements(std::vector<int>{7, 8, 8, 7, 1, 2}) == std::vector<int>{1, 7, 2});
}

TEST_CASE("parts of a facet are made whole where all of them are listed", "[topology]") {
  auto const t = merging();
  using Facets = std::vector<Facet<2>>;
  CHECK(t.carry_facets({{3, 1}, {0, 2}, {2, 5}, {5, 1}}) == Facets{{2, 1}, {0, 3}, {3, 1}});
  CHECK(t.carry_facets({{5, 2}, {2, 0}}) == Facets{{3, 0}});
  CHECK(t.cut_facets({{0, 2}, {2, 5}, {5, 1}}).empty());
  CHECK(t.cut_facets({{3, 1}, {2, 5}}) == Facets{{0, 2}, {2, 5}});
  CHECK_THROWS_WITH(t.carry_facets({{2, 5}}), says("nodes 0 and 2") && says("not all are listed"));
}

TEST_CASE("parts of a facet all of whose nodes stay are made whole too", "[topology]") {
  Transfer<3> const t({.old_nodes = 5, .merged = {{{0, 1, 2, 3}, {{0, 1, 2}, {0, 2, 3}}}}});
  using Facets = std::vector<Facet<3>>;
  CHECK(t.changed_facets({{0, 1, 2}, {0, 2, 3}}) == Facets{{0, 1, 2, 3}});
  CHECK(!t.changed_facets({{0, 1, 4}}));
}

TEST_CASE("facets that stay as they are, numbers included, are told from others", "[topology]") {
  auto const t = transfer(), merged = merging();
  using Facets = std::vector<Facet<2>>;
  CHECK(!t.changed_facets({{0, 1}, {1, 0}, {0, 5}}));
  CHECK(t.changed_facets({{0, 1}, {1, 2}}) == Facets{{0, 1}, {1, 8}, {8, 6}, {6, 2}});
  CHECK(!merged.changed_facets({{0, 1}}));
  CHECK(merged.changed_facets({{0, 1}, {1, 3}}) == Facets{{0, 1}, {1, 2}});
  CHECK(merged.changed_facets({{0, 2}, {2, 5}}) == Facets{{0, 3}});
  CHECK(!merged.changed_facets({}));
  Transfer<2> const both({.old_nodes = 4,
                          .renumbered = {0, {0, -1, 1, 2}},
                          .new_nodes = {{3, {{1, 0.5}, {2, 0.5}}}},
                          .gone = {{1, {{0, 1}}}},
                          .old_elements = {1},
                          .origins = {{{0, -1}}},
                          .divided = {{{1, 2}, {{1, 3}, {3, 2}}}}});
  CHECK(both.changed_facets({{3, 2}, {0, 2}}) == Facets{{2, 3}, {3, 1}, {0, 1}});
}

TEST_CASE("arrays of another size are refused", "[topology][errors]") {
  auto const t = transfer();
  CHECK_THROWS_WITH(t.carry_nodes(std::vector<double>(9)),
                    says("got 9 values of nodes") && says("6"));
  CHECK_THROWS_AS(t.carry_nodes(std::vector<Point<2>>(5)), Error);
  CHECK_THROWS_WITH(t.carry_elements(std::vector<int>(5)),
                    says("got 5 values of elements") && says("take 2"));
  CHECK_THROWS_AS(t.carry_elements(std::vector<int>(1)), Error);
  CHECK_THROWS_AS(t.carry_elements(std::vector<int>(2), 0, 3), Error);
  CHECK_THROWS_AS(t.carry_elements(std::vector<int>(6), 0, 2), Error);
}

}  // namespace pliant::test::transfer_test

#include <pliant/topology/transfer.hpp>

#include "support/catch.hpp"
#include "support/fields.hpp"

namespace pliant::test::transfer_test {

/// Two elements of 6 nodes, of which the second is split in four; two of another type, which stay.
inline Transfer<2> transfer() {
  return {6,
          {{6, {{1, 0.5}, {2, 0.5}}}, {7, {{2, 0.5}, {5, 0.5}}}, {8, {{1, 0.5}, {6, 0.5}}}},
          {2, 2},
          {{{0, -1}, {1, 0}, {1, 1}, {1, 2}, {1, 3}}, {{1, -1}, {0, -1}}}};
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
  Transfer<3> const solid(3, {{3, {{0, 0.5}, {1, 0.5}}}}, {1}, {{{0, -1}}});
  CHECK(solid.carry_facets({{0, 1, 2}}) == std::vector<Facet<3>>{{0, 1, 2}});
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

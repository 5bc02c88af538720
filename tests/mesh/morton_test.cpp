#include <pliant/mesh/morton.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

template <std::size_t Dim>
std::vector<Index> order_of(std::vector<std::array<double, Dim>> const& points) {
  return morton_order(std::span<std::array<double, Dim> const>(points));
}

TEST_CASE("the order is a permutation", "[mesh]") {
  Random random(1);
  for (std::size_t size : {0u, 1u, 2u, 1000u}) {
    auto order = order_of(random.field<2>(size, 3)), in_space = order_of(random.field<3>(size, 3));
    for (auto* each : {&order, &in_space}) {
      REQUIRE(each->size() == size);
      std::ranges::sort(*each);
      for (std::size_t i = 0; i < size; ++i) CHECK((*each)[i] == static_cast<Index>(i));
    }
  }
}

TEST_CASE("a grid is walked in the shape of a Z, quarter by quarter", "[mesh]") {
  std::vector<Point<2>> grid;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) grid.push_back({10.0 + x, 2.0 + y});

  CHECK(order_of(grid) == std::vector<Index>{0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15});

  std::vector<Point<3>> cube;
  for (int i = 0; i < 8; ++i)
    cube.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)});
  std::ranges::reverse(cube);
  CHECK(order_of(cube) == std::vector<Index>{7, 6, 5, 4, 3, 2, 1, 0});
}

TEST_CASE("points at one place keep their order", "[mesh]") {
  std::vector<Point<2>> points(7, {0.5, 0.25});
  CHECK(order_of(points) == std::vector<Index>{0, 1, 2, 3, 4, 5, 6});
  points[3] = {0, 0};
  CHECK(order_of(points) == std::vector<Index>{3, 0, 1, 2, 4, 5, 6});
}

TEST_CASE("neighbours in the order are neighbours in space", "[mesh]") {
  auto const points = Random(1).field<2>(4096, 0.5);
  auto const order = order_of(points);
  double length = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    auto const &a = points[static_cast<std::size_t>(order[i - 1])],
               &b = points[static_cast<std::size_t>(order[i])];
    length += std::hypot(a[0] - b[0], a[1] - b[1]);
  }
  // A mean step of some spacings of 1/64; in random order it would be half the square.
  CHECK(length / 4095 < 3.0 / 64);
}

}  // namespace pliant::test

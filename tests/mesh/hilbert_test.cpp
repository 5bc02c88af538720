#include <cmath>
#include <numeric>

#include <pliant/mesh/hilbert.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test::hilbert_test {

template <std::size_t Dim>
std::vector<Index> order_of(std::vector<std::array<double, Dim>> const& points) {
  return hilbert_order(std::span<std::array<double, Dim> const>(points));
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

TEST_CASE("codes are ordered whatever bits they share", "[mesh]") {
  constexpr int width = 63;
  Random random(3);
  auto const bits = [&](int count) {
    std::uint64_t code = 0;
    for (int b = 0; b < count; ++b) code = code << 1 | (random.below(2) == 1 ? 1u : 0u);
    return code;
  };
  // Leading bits that all differ, that a few share, that many share; and codes that are there twice.
  for (int different : {63, 20, 40}) {
    std::vector<std::uint64_t> codes;
    for (int i = 0; i < 40000; ++i)
      codes.push_back(different > 30 ? bits(different) : bits(different) << 43 | bits(3));
    codes.insert(codes.end(), codes.begin(), codes.begin() + 500);
    std::vector<Index> expected(codes.size());
    std::iota(expected.begin(), expected.end(), 0);
    std::ranges::stable_sort(expected, {},
                             [&](Index i) { return codes[static_cast<std::size_t>(i)]; });
    auto const code = [&](Index i) { return codes[static_cast<std::size_t>(i)]; };
    auto const leading = [&](Index i) { return code(i) >> (width - 33); };
    auto const n = static_cast<Index>(codes.size());
    CHECK(pliant::detail::ascending(n, leading, code) == expected);
    HostThreads const threads(4);
    CHECK(pliant::detail::ascending(n, leading, code) == expected);
  }
}

/// Which of a grid's coordinates change from each cell of the order to the next, by how much in all.
template <std::size_t Dim>
std::vector<int> steps_through_grid(int cells) {
  std::vector<Point<Dim>> grid;
  for (int i = 0; i < std::pow(cells, Dim); ++i) {
    Point<Dim> p;
    for (int k = 0, rest = i; k < int{Dim}; ++k, rest /= cells)
      p[static_cast<std::size_t>(k)] = rest % cells;
    grid.push_back(p);
  }
  auto const order = order_of(grid);
  std::vector<int> steps;
  for (std::size_t i = 1; i < order.size(); ++i) {
    int step = 0;
    for (std::size_t k = 0; k < Dim; ++k)
      step += static_cast<int>(std::abs(grid[static_cast<std::size_t>(order[i])][k] -
                                        grid[static_cast<std::size_t>(order[i - 1])][k]));
    steps.push_back(step);
  }
  return steps;
}

TEST_CASE("each cell of a grid shares a side with the next", "[mesh]") {
  for (int cells : {2, 4, 8}) {
    CHECK(std::ranges::count(steps_through_grid<2>(cells), 1) == cells * cells - 1);
    CHECK(std::ranges::count(steps_through_grid<3>(cells), 1) == cells * cells * cells - 1);
  }
}

TEST_CASE("a grid is walked quarter by quarter", "[mesh]") {
  std::vector<Point<2>> grid;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) grid.push_back({10.0 + x, 2.0 + y});
  auto const order = order_of(grid);
  for (std::size_t size : {4u, 16u})
    for (std::size_t first = 0; first < 64; first += size) {
      auto const square = [&](std::size_t i) {
        int const node = order[i], side = size == 4 ? 2 : 4;
        return std::pair{node % 8 / side, node / 8 / side};
      };
      for (std::size_t i = first; i < first + size; ++i) CHECK(square(i) == square(first));
    }
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

}  // namespace pliant::test::hilbert_test

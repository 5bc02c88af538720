#include <map>
#include <random>

#include <catch2/catch.hpp>

#include <pliant/topology/number_table.hpp>

// Numbers that a NumberTable gives.
namespace pliant::test {

template <std::size_t N, class Draw>
void check_numbers(int count, Draw const& draw) {
  NumberTable<N> table;
  std::map<std::array<Index, N>, Index> expected;
  int wrong = 0;
  for (int k = 0; k < count; ++k) {
    auto const nodes = draw();
    auto const [entry, is_new] = expected.try_emplace(nodes, static_cast<Index>(expected.size()));
    wrong += table.find_or_add(nodes) != std::pair(entry->second, is_new);
  }
  CHECK(wrong == 0);
  CHECK(expected.size() > 1000);
  CHECK(static_cast<int>(expected.size()) < count);
}

TEST_CASE("groups of nodes are numbered as they come", "[topology]") {
  std::mt19937 random(1);
  auto const any = [&](int count) {
    return static_cast<Index>(random() % static_cast<unsigned>(count));
  };

  check_numbers<2>(20000, [&] { return std::array{any(100), any(100)}; });
  check_numbers<4>(20000, [&] { return std::array{Index{-1}, any(20), any(20), any(20)}; });
}

TEST_CASE("a node of very many groups does not crowd the table", "[topology]") {
  std::mt19937 random(2);
  auto const any = [&](int count) {
    return static_cast<Index>(random() % static_cast<unsigned>(count));
  };

  check_numbers<2>(200000, [&] { return std::array{any(50000), Index{70000}}; });
}

}  // namespace pliant::test

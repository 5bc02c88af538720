#include <map>
#include <random>

#include <catch2/catch.hpp>

#include <pliant/topology/group_numbers.hpp>

// Numbers that number_groups gives.
namespace pliant::test {

template <std::size_t N, class Draw>
void check_numbers(int count, Draw const& draw) {
  UnsetVector<std::array<Index, N>> groups;
  for (int k = 0; k < count; ++k) groups.push_back(draw());
  auto const numbers = [&] {
    HostThreads const threads(3);
    return detail::number_groups(groups, 80000);
  }();
  auto const alone = detail::number_groups(groups, 80000);
  CHECK(alone.number == numbers.number);
  CHECK(alone.first == numbers.first);
  std::map<std::array<Index, N>, Index> expected;
  int wrong = 0;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    auto const next = static_cast<Index>(expected.size());
    auto const [entry, is_new] = expected.try_emplace(groups[k], next);
    wrong += numbers.number[k] != entry->second;
    if (is_new) wrong += numbers.first[static_cast<std::size_t>(next)] != static_cast<Index>(k);
  }
  CHECK(wrong == 0);
  CHECK(numbers.first.size() == expected.size());
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

TEST_CASE("a node may be the last of very many groups", "[topology]") {
  std::mt19937 random(2);
  auto const any = [&](int count) {
    return static_cast<Index>(random() % static_cast<unsigned>(count));
  };

  check_numbers<2>(200000, [&] { return std::array{any(50000), Index{70000}}; });
}

}  // namespace pliant::test

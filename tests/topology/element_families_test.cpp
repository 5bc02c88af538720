#include <iterator>

#include <pliant/topology/element_families.hpp>

#include "support/catch.hpp"

namespace pliant::test {

namespace {

std::vector<Index> elements(std::span<ElementFamilies::Member const> members) {
  std::vector<Index> list;
  for (auto const& member : members) list.push_back(member.element);
  return list;
}
std::vector<double> shares(ElementFamilies::Family const& family) {
  return {family.shares.begin(), family.shares.end()};
}
static_assert(std::forward_iterator<decltype(ElementFamilies().begin())>);

}  // namespace

TEST_CASE("families are read as they were listed", "[topology]") {
  ElementFamilies const families{
      {{{0, 4}, {0, 5}}, {{1, 2}}, {0.25, 0.75}},
      {{{1, 7}}, {{0, 3}, {0, 4}, {1, 0}}, {}, nullptr, true},
  };
  REQUIRE(families.size() == 2);
  CHECK(elements(families[0].before) == std::vector<Index>{4, 5});
  CHECK(elements(families[0].after) == std::vector<Index>{2});
  CHECK(families[0].after[0].type == 1);
  CHECK(shares(families[0]) == std::vector<double>{0.25, 0.75});
  CHECK(!families[0].mirrored);
  CHECK(elements(families[1].before) == std::vector<Index>{7});
  CHECK(elements(families[1].after) == std::vector<Index>{3, 4, 0});
  CHECK(shares(families[1]) == std::vector<double>{1});
  CHECK(families[1].mirrored);
  CHECK(ElementFamilies().empty());
}

TEST_CASE("families of known shapes are filled by several threads", "[topology]") {
  HostThreads const threads(3);
  RefinementPattern const pattern{};
  constexpr Index count = 100;
  ElementFamilies families(count, 8, [&](std::size_t f) {
    return ElementFamilies::Shape{.before = 1 + f % 3,
                                  .after = 1 + f % 4,
                                  .pattern = f % 2 == 0 ? &pattern : nullptr,
                                  .mirrored = f % 5 == 0};
  });
  detail::for_each_on_host(count, 8, [&](Index k) {
    auto const f = static_cast<std::size_t>(k);
    for (auto& member : families.before(f)) member = {0, k};
    for (auto& member : families.after(f)) member = {1, -k};
    families.shares(f)[0] = k;
  });

  Index k = 0;
  for (auto const& family : families) {
    auto const f = static_cast<std::size_t>(k);
    CHECK(elements(family.before) == std::vector<Index>(1 + f % 3, k));
    CHECK(elements(family.after) == std::vector<Index>(1 + f % 4, -k));
    auto expected = std::vector<double>(1 + f % 3, 1);
    expected[0] = k++;
    CHECK(shares(family) == expected);
    CHECK(family.pattern == (f % 2 == 0 ? &pattern : nullptr));
    CHECK(family.mirrored == (f % 5 == 0));
  }
  CHECK(k == count);
}

}  // namespace pliant::test

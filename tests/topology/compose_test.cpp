#include <pliant/topology/compose.hpp>

#include "support/catch.hpp"

namespace pliant::test {

namespace {

/// Chains of three slaves: of the last one, two masters have one in common. Between numbers are `apart`.
std::vector<Slave> chains(Index count, Index apart) {
  std::vector<Slave> slaves;
  for (Index c = 0; c < count; ++c) {
    auto const node = [&](Index k) { return apart * (8 * (count - 1 - c) + k); };
    slaves.push_back({node(4), {{node(0), 0.5}, {node(1), 0.5}}});
    slaves.push_back({node(3), {{node(1), 0.25}, {node(2), 0.75}}});
    slaves.push_back({node(5), {{node(4), 0.5}, {node(3), 0.5}}});
  }
  return slaves;
}

}  // namespace

TEST_CASE("slaves of slaves get free masters, each once, few and many slaves alike", "[topology]") {
  for (Index apart : {1, 1000}) {
    INFO("numbers " << apart << " apart");
    auto const slaves = compose(chains(5, apart));
    REQUIRE(slaves.size() == 15);
    for (std::size_t i = 0; i < 15; i += 3) {
      Index const first = 8 * apart * static_cast<Index>(i / 3);
      CHECK(slaves[i].node == first + 3 * apart);
      CHECK(slaves[i + 1].node == first + 4 * apart);
      auto const& last = slaves[i + 2];
      CHECK(last.node == first + 5 * apart);
      CHECK(last.masters == std::vector<std::pair<Index, double>>{
                                {first, 0.25}, {first + apart, 0.375}, {first + 2 * apart, 0.375}});
    }
  }
}

TEST_CASE("slaves that are listed twice or before their masters are refused", "[topology]") {
  for (Index apart : {1, 1000}) {
    INFO("numbers " << apart << " apart");
    auto twice = chains(3, apart);
    twice.push_back(twice[1]);
    CHECK_THROWS_WITH(compose(twice),
                      says(detail::message({"node ", 19 * apart, " is a slave twice"})));
    auto unordered = chains(1, apart);
    std::swap(unordered[0], unordered[2]);
    CHECK_THROWS_WITH(compose(unordered), says("does not come before it"));
  }
  CHECK_THROWS_WITH(compose({{-1, {{0, 1.0}}}}), says("there is no node -1"));
}

}  // namespace pliant::test

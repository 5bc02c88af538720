#include <algorithm>
#include <iterator>

#include <pliant/topology/weighted_nodes.hpp>

#include "support/catch.hpp"

namespace pliant::test {

namespace {

using Listed = std::vector<std::pair<Index, std::vector<NodeWeight>>>;

Listed listed(WeightedNodes const& nodes) {
  Listed list;
  for (auto const& [node, parents] : nodes) {
    list.emplace_back(node, std::vector<NodeWeight>{});
    for (auto const& [parent, weight] : parents) list.back().second.emplace_back(parent, weight);
  }
  return list;
}
/// A node with one, two or three parents.
std::pair<Index, std::vector<NodeWeight>> some_node(Index k) {
  std::vector<NodeWeight> parents;
  for (Index p = 0; p <= k % 3; ++p) parents.emplace_back(10 * k + p, 1.0 / (1 + k % 3));
  return {k, parents};
}
static_assert(std::forward_iterator<decltype(WeightedNodes().begin())>);

}  // namespace

TEST_CASE("weighted nodes are read as they were listed", "[topology]") {
  WeightedNodes nodes{{6, {{1, 0.5}, {2, 0.5}}}, {7, {{3, 1}}}};
  WeightedNodes const more{{8, {{0, 0.25}, {4, 0.25}, {5, 0.5}}}, {9, {}}};
  nodes.append(more);
  nodes.push_back(more[0]);

  CHECK(listed(nodes) == Listed{{6, {{1, 0.5}, {2, 0.5}}},
                                {7, {{3, 1}}},
                                {8, {{0, 0.25}, {4, 0.25}, {5, 0.5}}},
                                {9, {}},
                                {8, {{0, 0.25}, {4, 0.25}, {5, 0.5}}}});
  CHECK(nodes.size() == 5);
  CHECK(nodes.back().node == 8);
  CHECK(WeightedNodes().empty());
  CHECK(listed({}).empty());
}

TEST_CASE("weighted nodes that threads make, or fill in places, are in order", "[topology]") {
  for (int const threads : {1, 3}) {
    HostThreads const own(threads);
    constexpr Index count = 200;
    auto const made = WeightedNodes::made_on_host(count, 8, [](Index k, WeightedNodes& list) {
      auto const [node, parents] = some_node(k);
      list.push_back(node, parents);
    });
    std::vector<std::size_t> sizes;
    for (Index k = 0; k < count; ++k) sizes.push_back(some_node(k).second.size());
    WeightedNodes filled(sizes);
    detail::for_each_on_host(count, 8, [&](Index k) {
      auto const i = static_cast<std::size_t>(count - 1 - k);
      filled.set(i, made[i]);
    });

    Listed expected;
    for (Index k = 0; k < count; ++k) expected.push_back(some_node(k));
    CHECK(listed(made) == expected);
    CHECK(listed(filled) == expected);
  }
}

}  // namespace pliant::test

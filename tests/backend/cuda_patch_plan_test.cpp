#include <random>
#include <set>

#include "support/catch.hpp"
#include "support/plan_on_host.hpp"

using namespace pliant;
using pliant::test::plan_elements_on_host;

template <int Nodes>
using HostPlan = pliant::test::HostPlan<pliant::detail::PatchPlanner<Nodes>>;

namespace {

template <int Nodes>
using Table = std::vector<std::array<Index, Nodes>>;

/// Elements whose nodes lie near each other, with a few far ones and a few nodes that repeat.
template <int Nodes>
Table<Nodes> random_table(Index elements, Index nodes, unsigned seed) {
  std::mt19937 random(seed);
  Table<Nodes> table(static_cast<std::size_t>(elements));
  for (Index e = 0; e < elements; ++e)
    for (Index& node : table[static_cast<std::size_t>(e)]) {
      Index const near = static_cast<Index>(std::int64_t{e} * nodes / elements);
      node = random() % 50 == 0 ? static_cast<Index>(random() % static_cast<unsigned>(nodes))
                                : std::min(nodes - 1, near + static_cast<Index>(random() % 20));
    }
  return table;
}

template <int Nodes>
double share(std::size_t element, std::size_t a) {
  return static_cast<double>(element * Nodes + a + 1);  // integers add up without rounding
}

/// What the kernels do: shares to slots, slots summed along diagonals, sums added to nodes.
template <int Nodes>
std::vector<double> accumulate_by(HostPlan<Nodes> const& plan, std::size_t elements, Index nodes) {
  std::vector<double> out(static_cast<std::size_t>(nodes));
  for (std::size_t p = 0; p < static_cast<std::size_t>(plan.patches); ++p) {
    auto const size = static_cast<std::size_t>(plan.patch_size);
    std::vector<double> staging(size * Nodes);
    for (std::size_t e = p * size; e < std::min(elements, (p + 1) * size); ++e)
      for (std::size_t a = 0; a < Nodes; ++a) staging[plan.units[e].slot[a]] = share<Nodes>(e, a);
    auto const capacity = plan.node_capacity();
    for (std::size_t r = 0; r < capacity; ++r) {
      auto const [node, valence] = plan.nodes[p * capacity + r];
      if (node < 0) break;
      for (std::size_t d = 0; d < static_cast<std::size_t>(valence); ++d)
        out[static_cast<std::size_t>(node)] +=
            staging[plan.diagonals[p * plan.diagonal_capacity() + d] + r];
    }
  }
  return out;
}

template <int Nodes>
void check_plan(Index elements, Index nodes, int patch_size) {
  auto const table = random_table<Nodes>(elements, nodes, 7u + static_cast<unsigned>(elements));
  auto const plan = plan_elements_on_host<Nodes>(table, patch_size);

  std::vector<double> expected(static_cast<std::size_t>(nodes));
  bool same_nodes = true, inside = true;
  std::set<std::pair<std::size_t, int>> used;
  for (std::size_t e = 0; e < table.size(); ++e) {
    std::size_t const patch = e / static_cast<std::size_t>(patch_size);
    std::size_t const first = patch * static_cast<std::size_t>(patch_size);
    std::size_t const slots =
        std::min(table.size() - first, static_cast<std::size_t>(patch_size)) * Nodes;
    for (std::size_t a = 0; a < Nodes; ++a) {
      auto const& row = plan.units[e];
      expected[static_cast<std::size_t>(table[e][a])] += share<Nodes>(e, a);
      same_nodes &= plan.nodes[patch * plan.node_capacity() + row.local[a]].node == table[e][a];
      inside &= row.slot[a] < slots;
      used.emplace(patch, row.slot[a]);
    }
  }
  CHECK(same_nodes);
  CHECK(inside);
  CHECK(used.size() == table.size() * Nodes);
  CHECK(accumulate_by<Nodes>(plan, table.size(), nodes) == expected);
  CHECK(plan.capacity.nodes % 4 == 0);
  CHECK(plan.capacity.diagonals % 4 == 0);
}

}  // namespace

TEST_CASE("slots summed along diagonals equal direct accumulation", "[cuda][patch plan]") {
  check_plan<3>(1000, 500, 128);
  check_plan<4>(5000, 1200, 512);
  check_plan<4>(5000, 1200, 128);
  check_plan<8>(700, 900, 128);
  check_plan<27>(300, 2000, 64);
  check_plan<4>(1, 30, 128);
}

TEST_CASE("a node that all elements of a patch share has one slot for each", "[cuda][patch plan]") {
  Table<3> fan;
  for (Index e = 0; e < 200; ++e) fan.push_back({0, e + 1, (e + 1) % 200 + 1});
  auto const plan = plan_elements_on_host<3>(fan, 256);

  CHECK(plan.patches == 1);
  CHECK(plan.nodes[0].node == 0);
  CHECK(plan.nodes[0].valence == 200);
  CHECK(plan.capacity.diagonals == 200);
}

TEST_CASE("no elements make no patches", "[cuda][patch plan]") {
  CHECK(plan_elements_on_host<4>({}, 128).patches == 0);
}

TEST_CASE("writers of a warp are spread over the banks of shared memory", "[cuda][patch plan]") {
  // Strips of elements that share an edge each: of the slots that a node has, one is of a free bank.
  Table<4> strip;
  for (Index e = 0; e < 256; ++e) strip.push_back({e, e + 1, e + 300, e + 301});
  auto const plan = plan_elements_on_host<4>(strip, 256);
  int worst = 0;
  for (std::size_t first = 0; first < strip.size(); first += 32)
    for (std::size_t a = 0; a < 4; ++a) {
      std::array<int, 32> writers{};
      for (std::size_t e = first; e < first + 32; ++e)
        worst = std::max(worst, ++writers[plan.units[e].slot[a] % 32]);
    }
  CHECK(worst <= 2);
}

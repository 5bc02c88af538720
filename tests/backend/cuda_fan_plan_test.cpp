#include <random>
#include <set>

#include <pliant/body/numbering.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/mesh/box.hpp>

#include "support/catch.hpp"
#include "support/plan_on_host.hpp"

namespace pliant::test::cuda_fan_plan_test {

using Table = std::vector<std::array<Index, 4>>;
using Plan = HostPlan<detail::FanPlanner>;

Table box_table(int cells) {
  auto const mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  return std::get<0>(Numbering<Tet4>(mesh).tables);
}
/// The same, turned and shuffled, so that nothing tells which tetrahedra were a cell.
Table shuffled(Table table) {
  std::mt19937 random(3);
  for (auto& t : table)
    for (auto turns = random() % 3; turns > 0; --turns) t = {t[1], t[2], t[0], t[3]};
  for (std::size_t e = 0; e < table.size(); ++e)
    std::swap(table[e], table[std::min(table.size() - 1, e + random() % 20)]);
  return table;
}
/// Elements whose nodes lie near each other, some with a node twice.
Table random_table(Index elements) {
  std::mt19937 random(5);
  Table table(static_cast<std::size_t>(elements));
  for (Index e = 0; e < elements; ++e)
    for (Index& node : table[static_cast<std::size_t>(e)])
      node = e / 5 + static_cast<Index>(random() % 40);
  return table;
}

bool is_even_permutation(std::array<Index, 4> a, std::array<Index, 4> const& of) {
  bool even = true;
  for (std::size_t k = 0; k < 4; ++k) {
    if (a[k] == of[k]) continue;
    auto const at = std::find(a.begin() + static_cast<std::ptrdiff_t>(k), a.end(), of[k]);
    if (at == a.end()) return false;
    std::iter_swap(a.begin() + static_cast<std::ptrdiff_t>(k), at);
    even = !even;
  }
  return even || std::set(of.begin(), of.end()).size() < 4;
}

/// What an element gives a node of its own: an integer, which adds up without rounding.
double share(std::size_t element, Index node) {
  return static_cast<double>(element * 7 + static_cast<std::size_t>(node) % 5 + 1);
}

/// Goes around fans as kernels do. Checks each element on the way.
struct Outcome {
  std::vector<double> sums;
  std::size_t fans = 0, closed = 0;
};
Outcome accumulate_by(Plan const& plan, Table const& table, Index nodes) {
  Outcome outcome{std::vector<double>(static_cast<std::size_t>(nodes))};
  std::vector<int> seen(table.size());
  bool even = true, inside = true;
  auto const capacity = static_cast<std::size_t>(plan.capacity.fans);
  for (std::size_t p = 0; p < static_cast<std::size_t>(plan.patches); ++p) {
    auto const* const units = plan.units.data() + p * capacity * detail::most_fan_visits;
    auto const* const patch_nodes = plan.nodes.data() + p * plan.node_capacity();
    std::vector<double> staging(static_cast<std::size_t>(plan.capacity.slots));
    for (std::size_t f = 0; f < capacity && units[f].element() > 0; ++f) {
      ++outcome.fans;
      auto const visit = [&](std::size_t j) { return units[j * capacity + f]; };
      auto const node = [&](std::size_t j) { return patch_nodes[visit(j).node()].node; };
      auto const slot = [&](std::size_t j) -> double& {
        inside &= visit(j).slot() < plan.capacity.slots;
        return staging[static_cast<std::size_t>(visit(j).slot())];
      };
      auto const size = static_cast<std::size_t>(units[f].element());
      double first = 0, second = 0, kept = 0;
      for (std::size_t k = 0; k < size; ++k) {
        std::size_t const e = p * static_cast<std::size_t>(plan.patch_size) +
                              static_cast<std::size_t>(visit(3 + k).element());
        REQUIRE(e < table.size());
        ++seen[e];
        even &= is_even_permutation({node(0), node(1), node(2 + k), node(3 + k)}, table[e]);
        first += share(e, node(0));
        second += share(e, node(1));
        slot(2 + k) = kept + share(e, node(2 + k));
        kept = share(e, node(3 + k));
      }
      bool const closed = visit(2 + size).slot() == visit(2).slot();
      outcome.closed += closed;
      slot(2 + size) = closed ? slot(2) + kept : kept;
      slot(0) = first;
      slot(1) = second;
    }
    for (std::size_t r = 0; r < plan.node_capacity(); ++r) {
      auto const [n, valence] = patch_nodes[r];
      for (std::size_t d = 0; d < static_cast<std::size_t>(valence); ++d)
        outcome.sums[static_cast<std::size_t>(n)] +=
            staging[plan.diagonals[p * plan.diagonal_capacity() + d] + r];
    }
  }
  CHECK(even);
  CHECK(inside);
  CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
  return outcome;
}

void check_sums(Table const& table, int patch_size) {
  Index nodes = 0;
  for (auto const& t : table) nodes = std::max(nodes, 1 + *std::max_element(t.begin(), t.end()));
  std::vector<double> expected(static_cast<std::size_t>(nodes));
  for (std::size_t e = 0; e < table.size(); ++e)
    for (Index node : table[e]) expected[static_cast<std::size_t>(node)] += share(e, node);
  auto const plan = plan_on_host<detail::FanPlanner>(table, patch_size);
  CHECK(accumulate_by(plan, table, nodes).sums == expected);
}

TEST_CASE("what fans add up equals direct accumulation", "[cuda][fan plan]") {
  check_sums(box_table(6), 768);
  check_sums(box_table(5), 96);
  check_sums(shuffled(box_table(6)), 384);
  check_sums(random_table(3000), 768);
  check_sums({{0, 1, 2, 3}}, 768);
}

TEST_CASE("the six tetrahedra of a cell become a fan again", "[cuda][fan plan]") {
  auto const table = box_table(8);
  auto const plan = plan_on_host<detail::FanPlanner>(table, 768);
  auto const outcome = accumulate_by(plan, table, 729);
  CHECK(outcome.fans == table.size() / 6);
  CHECK(outcome.closed == outcome.fans);
}

TEST_CASE("most tetrahedra are in fans of several, whatever their order", "[cuda][fan plan]") {
  auto const table = shuffled(box_table(8));
  auto const plan = plan_on_host<detail::FanPlanner>(table, 768);
  auto const outcome = accumulate_by(plan, table, 729);
  CHECK(3 * outcome.fans < table.size());
}

TEST_CASE("a ring of more tetrahedra than a fan takes becomes several", "[cuda][fan plan]") {
  for (Index n : {7, 30, 100}) {
    Table ring;
    for (Index e = 0; e < n; ++e) ring.push_back({0, 1, 2 + e, 2 + (e + 1) % n});
    auto const plan = plan_on_host<detail::FanPlanner>(ring, 384);
    auto const outcome = accumulate_by(plan, ring, n + 2);
    INFO(n << " tetrahedra");
    CHECK(outcome.fans >= static_cast<std::size_t>((n + 5) / 6));
    CHECK(outcome.fans <= static_cast<std::size_t>(n / 2));
    check_sums(ring, 384);
  }
}

TEST_CASE("rows of tetrahedra around one edge become a fan each", "[cuda][fan plan]") {
  // Two rows, and a closed one; those of each in any order.
  Table const rows{{0, 1, 6, 7}, {0, 1, 4, 5},  {0, 1, 3, 4},
                   {0, 1, 8, 9}, {0, 1, 10, 8}, {0, 1, 9, 10}};
  auto const plan = plan_on_host<detail::FanPlanner>(rows, 768);
  auto const outcome = accumulate_by(plan, rows, 11);
  CHECK(outcome.fans == 3);
  CHECK(outcome.closed == 1);
  check_sums(rows, 768);
}

TEST_CASE("tetrahedra that all follow the same one are in one fan each", "[cuda][fan plan]") {
  check_sums({{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 3, 5}}, 768);
  check_sums({{0, 1, 3, 4}, {0, 1, 3, 5}, {0, 1, 2, 3}, {0, 1, 5, 2}}, 768);
  check_sums({{0, 1, 2, 3}, {0, 1, 5, 3}, {0, 1, 3, 4}}, 768);
  check_sums({{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 1, 3, 2}, {0, 1, 2, 3}}, 768);
}

TEST_CASE("a patch may have as many fans as elements", "[cuda][fan plan]") {
  // Of tetrahedra with one node each, of which none follows another.
  Table alone;
  for (Index e = 0; e < 1024; ++e) alone.push_back({e, e, e, e});
  auto const plan = plan_on_host<detail::FanPlanner>(alone, 1024);
  CHECK(accumulate_by(plan, alone, 1024).fans == 1024);
  check_sums(alone, 1024);
}

TEST_CASE("a patch with too many nodes for fans is counted, not planned", "[cuda][fan plan]") {
  std::vector<std::array<Index, 4>> apart;
  for (Index e = 0; e < 300; ++e) apart.push_back({4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3});
  detail::PlanMemory needed;
  detail::FanPlanner const sizes(needed, 384, 0);
  std::vector<Index> words(static_cast<std::size_t>(needed.most()) / sizeof(Index) + 1);
  detail::PlanMemory memory(words.data());
  detail::FanPlanner planner(memory, 384, 300);
  auto const counts = planner.count(detail::OneThread{}, apart[0].data(), 4);
  CHECK(counts.nodes == 1200);
  CHECK(counts.nodes > detail::FanSplitter::most_nodes);
}

}  // namespace pliant::test::cuda_fan_plan_test

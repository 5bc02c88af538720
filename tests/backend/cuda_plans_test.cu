#include <algorithm>
#include <cstring>
#include <random>

#include <pliant/body/numbering.hpp>
#include <pliant/cuda.hpp>
#include <pliant/mesh/box.hpp>

#include "support/catch.hpp"
#include "support/plan_on_host.hpp"

// What a GPU plans for the patches of a table, against what one host thread does.
namespace pliant::test::cuda_plans_test {

template <class Planner>
using TableOf = std::vector<std::array<Index, Planner::nodes>>;

/// A box of tetrahedra in the order of a body.
std::vector<std::array<Index, 4>> box(int cells) {
  auto const mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  return std::get<0>(Numbering<Tet4>(mesh).tables);
}
/// Elements of which near ones share nodes.
template <int Nodes>
std::vector<std::array<Index, Nodes>> random_table(Index elements) {
  std::mt19937 random(5);
  std::vector<std::array<Index, Nodes>> table(static_cast<std::size_t>(elements));
  for (Index e = 0; e < elements; ++e)
    for (Index& node : table[static_cast<std::size_t>(e)])
      node = e / 5 + static_cast<Index>(random() % 40);
  return table;
}

template <class Planner>
void check_same(detail::PatchPlan<Planner> const& plan, HostPlan<Planner> const& expected) {
  auto const same = [](auto const& array, auto const& list) {
    using U = typename std::remove_cvref_t<decltype(list)>::value_type;
    std::vector<U> values(array.size());
    array.download(values);
    return values.size() == list.size() &&
           std::memcmp(values.data(), list.data(), values.size() * sizeof(U)) == 0;
  };
  CHECK(plan.capacity.nodes == expected.capacity.nodes);
  CHECK(plan.capacity.fans == expected.capacity.fans);
  CHECK(plan.capacity.slots == expected.capacity.slots);
  CHECK(same(plan.units, expected.units));
  CHECK(same(plan.nodes, expected.nodes));
  CHECK(same(plan.diagonals, expected.diagonals));
}

/// Plans a table on the device.
template <class Planner>
detail::PatchPlan<Planner> planned(TableOf<Planner> const& table, detail::PatchCuts const& cuts,
                                   detail::KnownPatches<Planner> const& known) {
  Cuda<double> const backend;
  std::vector<Index> flat;
  for (auto const& row : table) flat.insert(flat.end(), row.begin(), row.end());
  auto const connectivity = upload(backend, flat), first = upload(backend, cuts.first());
  return detail::plan_patches<Planner>(
      backend, {connectivity.data(), Planner::nodes, cuts.size(), first.data()}, cuts, known,
      [](auto const&) { return true; });
}

/// The plan of a table on the device against that of one host thread, whatever capacity it was thought to need.
template <class Planner>
void compare_plan(TableOf<Planner> const& table, int patch_size) {
  auto const expected = plan_on_host<Planner>(table, patch_size);
  auto const& right = expected.capacity;
  detail::PatchCounts const too_few{right.nodes, right.diagonals, right.fans, right.slots - 4};
  detail::PatchCounts const too_many{2 * right.nodes, 2 * right.diagonals, 2 * right.fans,
                                     2 * right.slots};
  detail::PatchCuts const cuts(static_cast<Index>(table.size()), patch_size);
  for (detail::PatchCounts const& guess : {detail::PatchCounts{}, right, too_few, too_many}) {
    detail::PatchPlan<Planner> of_guess;
    of_guess.capacity = guess;
    check_same(planned<Planner>(table, cuts, {&of_guess, nullptr}), expected);
  }
}

/// Blocks of 40 elements, of which some stay where others get more elements in the middle of a table, or lose some. Whether
/// patches had room where they were, without which all are planned again.
template <class Planner>
bool compare_changed_plan(int patch_size, bool grows) {
  auto const few = random_table<4>(3000);
  ElementBlocks blocks_of_few, blocks_of_many;
  TableOf<Planner> many;
  for (Index e = 0; e <= 3000; e += 40) {
    blocks_of_few.first.push_back(e);
    blocks_of_many.first.push_back(static_cast<Index>(many.size()));
    if (e == 3000) break;
    bool const other = e == 1000 || e == 1640;
    blocks_of_few.stays.push_back(!other);
    auto const begin = few.begin() + e;
    many.insert(many.end(), begin, begin + 40);
    if (other) many.insert(many.end(), begin, begin + 17);
  }
  blocks_of_many.stays = blocks_of_few.stays;
  blocks_of_few.first_before = blocks_of_many.first;
  blocks_of_many.first_before = blocks_of_few.first;
  detail::PatchCuts const cuts_of_few(3000, patch_size, blocks_of_few),
      cuts_of_many(static_cast<Index>(many.size()), patch_size, blocks_of_many);
  auto const& before = grows ? few : many;
  auto const& after = grows ? many : few;
  auto const& cuts_before = grows ? cuts_of_few : cuts_of_many;
  auto const& cuts_after = grows ? cuts_of_many : cuts_of_few;
  auto const plan_before = planned<Planner>(before, cuts_before, {});
  auto const known = cuts_after.known_from(cuts_before, grows ? blocks_of_many : blocks_of_few);
  CHECK(std::ranges::count(known, -1) > 0);
  CHECK(std::ranges::count(known, -1) < static_cast<std::ptrdiff_t>(known.size()));

  auto const first_before = upload(Cuda<double>{}, cuts_before.first());
  auto const plan = planned<Planner>(after, cuts_after, {&plan_before, first_before.data(), known});
  check_same(plan, plan_on_host<Planner>(after, cuts_after, plan.capacity));
  return plan.capacity.nodes == plan_before.capacity.nodes &&
         plan.capacity.diagonals == plan_before.capacity.diagonals &&
         plan.capacity.fans == plan_before.capacity.fans &&
         plan.capacity.slots == plan_before.capacity.slots;
}

TEST_CASE("patches that stay in a change keep their plans", "[cuda]") {
  int of_fans = 0, of_elements = 0;
  for (bool grows : {true, false})
    for (int patch_size : {64, 100, 768}) {
      INFO(patch_size << " elements in a patch, more of them: " << grows);
      of_fans += compare_changed_plan<detail::FanPlanner>(patch_size, grows);
      of_elements += compare_changed_plan<detail::PatchPlanner<4>>(patch_size, grows);
    }
  CHECK(of_fans > 0);
  CHECK(of_elements > 0);
}

/// The room for diagonals behind changes that had all patches planned again.
template <class Planner>
void check_room_behind_changes(TableOf<Planner> const& table, int patch_size) {
  detail::PatchCuts const cuts(static_cast<Index>(table.size()), patch_size);
  auto const first = upload(Cuda<double>{}, cuts.first());
  auto const needed = plan_on_host<Planner>(table, cuts).capacity.diagonals;
  auto plan = planned<Planner>(table, cuts, {});
  for (int change = 0; change < 8; ++change) {
    INFO("change " << change);
    std::vector<Index> const known(static_cast<std::size_t>(cuts.count()), -1);
    plan = planned<Planner>(table, cuts, {&plan, first.data(), known});
    CHECK(plan.capacity.diagonals >= needed);
    CHECK(plan.capacity.diagonals <= 2 * std::max(needed, Planner::usual(patch_size).diagonals));
  }
  check_same(plan, plan_on_host<Planner>(table, cuts, plan.capacity));
}

TEST_CASE("patches that are planned again and again have room for what they need", "[cuda]") {
  check_room_behind_changes<detail::FanPlanner>(box(9), 768);
  check_room_behind_changes<detail::FanPlanner>(random_table<4>(3000), 100);
  check_room_behind_changes<detail::PatchPlanner<4>>(random_table<4>(3000), 96);
}

using Patches = detail::ElementPatches<double, 4>;

/// Blocks of 40 elements, of which each `distance`-th is planned again.
ElementBlocks blocks_of_40(Index count, std::size_t distance) {
  ElementBlocks blocks;
  for (Index e = 0; e < count; e += 40) blocks.first.push_back(e);
  blocks.first.push_back(count);
  blocks.first_before = blocks.first;
  for (std::size_t b = 0; b + 1 < blocks.first.size(); ++b)
    blocks.stays.push_back(b % distance != 0);
  return blocks;
}
DeviceArray<Index> rows_of(Cuda<double> const& backend,
                           std::vector<std::array<Index, 4>> const& table) {
  std::vector<Index> flat;
  for (auto const& row : table) flat.insert(flat.end(), row.begin(), row.end());
  return upload(backend, flat);
}
/// Against what a host thread plans.
void check_patches(Patches const& patches, std::vector<std::array<Index, 4>> const& table,
                   ElementBlocks const& blocks) {
  detail::PatchCuts const cuts(static_cast<Index>(table.size()), patches.size(), blocks);
  CHECK(std::ranges::equal(patches.bounds(), cuts.first()));
  auto const check_view = [&]<class Planner>(Planner*, auto const& view) {
    REQUIRE(view.capacity.nodes >= plan_on_host<Planner>(table, cuts).capacity.nodes);
    auto const expected = plan_on_host<Planner>(table, cuts, view.capacity);
    auto const same = [](auto const* memory, auto values) {
      auto const there = values;
      auto const bytes = values.size() * sizeof(values[0]);
      REQUIRE(cudaMemcpy(values.data(), memory, bytes, cudaMemcpyDeviceToHost) == cudaSuccess);
      return std::memcmp(values.data(), there.data(), bytes) == 0;
    };
    CHECK(view.capacity.nodes == expected.capacity.nodes);
    CHECK(same(view.units, expected.units));
    CHECK(same(view.nodes, expected.nodes));
    CHECK(same(view.diagonals, expected.diagonals));
  };
  if (patches.has_fans())
    check_view(static_cast<detail::FanPlanner*>(nullptr), patches.fan_view(nullptr, {}));
  else
    check_view(static_cast<detail::PatchPlanner<4>*>(nullptr), patches.patch_view(nullptr, {}));
}

/// Patches of blocks of 40 elements, of which each `distance`-th is planned again beside other work, against what a host thread
/// plans. Whether they are fans.
bool compare_plan_beside(std::vector<std::array<Index, 4>> const& table, NodeOrder order,
                         std::size_t distance) {
  Cuda<double> const backend;
  auto const count = static_cast<Index>(table.size());
  auto const blocks = blocks_of_40(count, distance);
  auto const rows = rows_of(backend, table);
  Patches before(rows.data(), count), after(rows.data(), count), given_up(rows.data(), count);
  before.plan(backend, order, blocks);

  after.plan_beside(backend, order, blocks, before);
  after.settle(backend);
  given_up.plan_beside(backend, order, blocks, before);
  check_patches(after, table, blocks);
  return after.has_fans();
}

TEST_CASE("patches are planned beside other work as they are at once", "[cuda]") {
  auto const few = box(9), many = box(37);
  for (std::size_t distance : {3, 100}) {
    INFO("one of " << distance << " blocks is planned again");
    CHECK_FALSE(compare_plan_beside(few, NodeOrder::any_even, distance));
    CHECK_FALSE(compare_plan_beside(many, NodeOrder::as_given, distance));
    CHECK(compare_plan_beside(many, NodeOrder::any_even, distance));
  }
}

TEST_CASE("patches of tables that are planned beside each other have room for what they need",
          "[cuda]") {
  Cuda<double> const backend;
  auto const compact = box(9);
  auto apart = compact;
  for (Index node = 0; auto& element : apart)
    for (Index& n : element) n = node++;
  auto const count = static_cast<Index>(compact.size());
  auto const rows = rows_of(backend, compact), rows_apart = rows_of(backend, apart);
  auto const blocks = blocks_of_40(count, 1);
  Patches before(rows.data(), count);
  before.plan(backend, NodeOrder::as_given, blocks);
  Patches same(rows.data(), count), grown(rows_apart.data(), count);
  for (bool grown_first : {true, false}) {
    (grown_first ? grown : same).plan_beside(backend, NodeOrder::as_given, blocks, before);
    (grown_first ? same : grown).plan_beside(backend, NodeOrder::as_given, blocks, before);
    grown.settle(backend);
    same.settle(backend);
    check_patches(grown, apart, blocks);
    check_patches(same, compact, blocks);
  }
}

TEST_CASE("a GPU plans patches as one host thread does", "[cuda]") {
  compare_plan<detail::PatchPlanner<4>>(random_table<4>(5000), 768);
  compare_plan<detail::PatchPlanner<4>>(random_table<4>(769), 768);
  compare_plan<detail::PatchPlanner<4>>(random_table<4>(100), 96);
  compare_plan<detail::PatchPlanner<3>>(random_table<3>(1000), 256);
  compare_plan<detail::PatchPlanner<8>>(random_table<8>(1000), 64);
  compare_plan<detail::PatchPlanner<10>>(random_table<10>(300), 64);
}

TEST_CASE("a GPU plans fans as one host thread does", "[cuda]") {
  compare_plan<detail::FanPlanner>(box(9), 768);
  compare_plan<detail::FanPlanner>(box(5), 100);
  compare_plan<detail::FanPlanner>(random_table<4>(3000), 768);
  // Tetrahedra with one node each are in fans of one element.
  TableOf<detail::FanPlanner> alone;
  for (Index e = 0; e < 1024; ++e) alone.push_back({e, e, e, e});
  compare_plan<detail::FanPlanner>(alone, 1024);
}

}  // namespace pliant::test::cuda_plans_test

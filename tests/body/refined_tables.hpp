#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/element_sums.hpp>
#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/body/element_numbers_on.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/element_table.hpp>
#include <pliant/topology/plan.hpp>

#include "body/refined_mesh.hpp"
#include "body/table_kernels.hpp"
#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// What belongs to the elements of a mesh that is refined and coarsened in a backend's memory, beside what the host makes of the
// same mesh.
namespace pliant::test {

/// Tables of a mesh that is refined: from rows in the backend's memory, and from connectivity of the host.
template <class B, Element E>
struct Tables {
  using T = typename B::scalar;
  using M = Mesh<E>;
  using Elements = typename B::template Elements<E::nodes>;
  template <class U>
  using Array = typename B::template Array<U>;
  using Energy = WeightedSquares<E::nodes, E::dim>;
  static constexpr int groups = 2, dim = E::dim, width = row_width<Elements>;
  static constexpr bool by_blocks = PlansByBlocks<Elements, B>;

  RefinedMesh<B, E> mesh;
  B const& backend;
  // By the user's number of the element, and values by column then.
  std::vector<Tag> own_tags;
  std::vector<double> own_values;
  Elements on, host;
  Array<Tag> tags;
  Array<double> values;  // (2, elements)
  ElementNumbersOn<B> numbers;
  ElementBlocks blocks;
  std::vector<std::vector<Index>> leaves_of_blocks;

  Tables(B const& given, M const& of) : mesh(given, of), backend(mesh.backend) {
    Random random(3);
    for (Index c = 0; c < mesh.first.count(); ++c) {
      own_tags.push_back(static_cast<Tag>(random.below(2)));
      for (int k = 0; k < 2; ++k) own_values.push_back(random());
    }
    values = upload(backend, by_column(mesh.first.cells));
    tags = upload(backend, by_place(mesh.first.cells));
    backend.synchronize();
    blocks.first = mesh.order.told_first_of_block();
    make({nullptr, width}, false);
  }

  void refine(std::vector<Index> const& marked) {
    auto const before = topology();
    change(before, {.refine = {ranks(*before, marked)}}, [&] {
      mesh.refine(marked);
      numbers.follow(backend, mesh.tree, mesh.refined);
      auto const places = std::make_shared<RefinedPlaces<B>>(
          backend, mesh.order.view(), mesh.refined,
          mesh.order.count() - mesh.order.count_before() + mesh.refined.leaves);
      return std::pair{[=, this](auto const& kernel) {
                         return sum_at(kernel, places->go.data(), places->go_count);
                       },
                       [=, this](auto const& kernel) {
                         return sum_at(kernel, places->come.data(), places->come_count);
                       }};
    });
  }
  /// Merges families of marked leaves; returns how many.
  Index coarsen(std::vector<Index> const& marked) {
    auto const before = topology();
    change(before, {.coarsen = {ranks(*before, marked)}}, [&] {
      mesh.coarsen(marked);
      numbers.follow(backend, mesh.tree, mesh.coarsened);
      return std::pair{[this](auto const& kernel) {
                         return sum_if(kernel, detail::IsMergedLeaf{mesh.order.view()});
                       },
                       [this](auto const& kernel) {
                         return sum_if(kernel, detail::IsNewLeaf{mesh.order.view()});
                       }};
    });
    return mesh.coarsened.merged;
  }
  /// Gives elements groups and values at random.
  void mix(Random& random) {
    for (Tag& tag : own_tags) tag = static_cast<Tag>(random.below(2));
    for (double& value : own_values) value = random();
    auto const users = users_now();
    auto const list = by_place(users);
    values = upload(backend, by_column(users));
    tags = upload(backend, list);
    for (Elements* const table : {&on, &host}) {
      table->tags().upload(list);
      table->regroup();
    }
  }

  /// By the place, and cells by the number.
  std::vector<Index> users_now() const {
    auto list = zeros<Index>(backend, at(on.count()));
    backend.for_each(on.count(),
                     detail::PutNumbers{numbers.of(mesh.order.view()), nullptr, list.data()});
    return download<Index>(list);
  }
  std::vector<Index> cells_now() const {
    std::vector<Index> list(at(on.count()));
    std::iota(list.begin(), list.end(), Index{0});
    // Numbers that no element has are noted, and go to the first one.
    for (Index const number : {Index{-1}, on.count(), Index{-7}}) {
      auto cells = looked_up({0, number});
      CHECK(cells[2] != 0);
      CHECK(cells[1] == cells[0]);
    }
    auto cells = looked_up(list);
    CHECK(cells.back() == 0);
    cells.pop_back();
    return cells;
  }
  /// The cells of elements with these numbers, and behind them whether one was unknown.
  std::vector<Index> looked_up(std::vector<Index> const& list) const {
    auto const from = upload(backend, list);
    auto cells = zeros<Index>(backend, list.size() + 1);
    auto const count = static_cast<Index>(list.size());
    backend.for_each(count, detail::LookUpCells{numbers.of(mesh.order.view()), on.count(),
                                                from.data(), cells.data(), cells.data() + count});
    return download<Index>(cells);
  }

  /// The mesh as it is.
  std::shared_ptr<Topology<M> const> topology() const {
    std::vector<Index> divided, arriving;
    auto const cells = static_cast<Index>(mesh.host->cells().size());
    for (Index c = 0; c < cells; ++c)
      if (!mesh.host->is_leaf(c)) divided.push_back(c);
    auto set = CellSet::range(0, cells).changed(
        divided, cells, [](Index c) { return c; }, arriving);
    return std::make_shared<Topology<M> const>(mesh.host, std::vector{std::move(set)});
  }
  static std::vector<Index> ranks(Topology<M> const& of, std::vector<Index> cells) {
    for (Index& c : cells) c = of.cells[0].rank(c);
    return cells;
  }
  std::vector<Tag> by_place(std::vector<Index> const& users) const {
    std::vector<Tag> list;
    for (Index const user : users) list.push_back(own_tags[at(user)]);
    return list;
  }
  std::vector<double> by_column(std::vector<Index> const& users) const {
    std::vector<double> list;
    for (std::size_t k = 0; k < 2; ++k)
      for (Index const user : users) list.push_back(own_values[2 * at(user) + k]);
    return list;
  }

  /// Makes a change, and what follows from it. make_change() gives sum(kernel) of the elements that go, and of those that come.
  template <class Change>
  void change(std::shared_ptr<Topology<M> const> const& before, MarkedElements const& marked,
              Change const& make_change) {
    auto const plan = plan_change<M>(before, marked, {}, {}, {{0}, {}, {}});
    auto const users = users_now();
    auto const tags_before = by_place(users);
    std::vector<double> volumes;
    for (Index const user : users)
      volumes.push_back(
          volume<E, MassQuadrature<E>>(nodal(*before, before->template nodes_of<E>(user))));
    auto const volumes_on = upload(backend, volumes);
    auto const energy_before = energy(on);
    auto const [sum_gone, sum_come] = make_change();

    CHECK(std::vector{sum_gone(IsInGroup<0>{}), sum_gone(IsInGroup<1>{})} ==
          counts_of_gone(tags_before));
    double const gone = sum_gone(Energy{});
    if (plan) {
      own_tags = plan->transfer.carry_elements(own_tags);
      own_values = plan->transfer.carry_elements(own_values, 0, 2);
    }
    tags = inherited_values(backend, mesh.order.view(), std::as_const(tags).data());
    values = inherited_values(backend, mesh.order.view(), std::as_const(values).data(), 2,
                              volumes_on.data());
    backend.synchronize();
    blocks = blocks_after_change(mesh.order.told_first_of_block(), blocks.first);
    make(on.rows_of_nodes(), true);
    double const made = sum_come(Energy{});
    CHECK((made > 0) == plan.has_value());
    CHECK(std::abs(made - gone - (energy(on) - energy_before)) <= 1e-13 * energy_before);
  }

  Array<Index> rows(ElementRows const& before) {
    return element_rows<E, width>(backend, mesh.tree.view(), mesh.order.view(), mesh.rows.of_node(),
                                  before);
  }
  Array<Tag> copy_of_tags() {
    auto copy = zeros<Tag>(backend, tags.size());
    detail::copy_values(backend, std::as_const(tags).data(), copy.data(), tags.size());
    return copy;
  }

  void make(ElementRows const& before, bool changed) {
    Index const node_rows = mesh.rows.count();
    auto next = elements_of_rows(backend, rows(before), groups, copy_of_tags(), node_rows,
                                 node_order<E>, blocks, changed ? &on : nullptr);
    settle(backend, next);
    on = std::move(next);
    if (!changed) numbers = {backend, mesh.tree, detail::cells_of_type<E>(false)};
    check_rows(node_rows, changed);
    check_results(node_rows);
  }

  /// Rows, numbers, tags and values are those that follow from the tree on the host.
  void check_rows(Index node_rows, bool changed) {
    auto const now = topology();
    auto const& set = now->cells[0];
    auto const ordered = elements_in_order(*now, mesh.first);
    auto wanted = ordered.blocks[0];
    REQUIRE(blocks.first == wanted.first);
    std::vector<std::vector<Index>> leaves;
    for (auto const& own : ordered.cells[0]) leaves.push_back(own->cells);
    if (changed) {
      for (auto& own : leaves_of_blocks)
        for (Index& c : own) c = mesh.renumbered.cells[c];
      for (std::size_t b = 0; b < leaves.size(); ++b)
        wanted.stays.push_back(leaves[b] == leaves_of_blocks[b] ? 1 : 0);
      CHECK(blocks.stays == wanted.stays);
      wanted.first_before = blocks.first_before;
    }
    leaves_of_blocks = leaves;

    auto const of_nodes = mesh.rows.download_all();
    auto const all = rows_of_blocks<E>(*now, ordered.cells[0], wanted, true, of_nodes);
    std::vector<Index> padded;
    for (auto const& row : all) {
      padded.insert(padded.end(), row.begin(), row.end());
      padded.resize(padded.size() + width - E::nodes, 0);
    }
    REQUIRE(on.count() == static_cast<Index>(all.size()));
    CHECK(taken(backend, on.rows_of_nodes().nodes, on.count() * width) == padded);

    ElementNumbers const expected(ordered.cells[0], wanted.first, set);
    CHECK(users_now() == expected.all());
    CHECK(cells_now() == std::vector<Index>(set.begin(), set.end()));

    auto const tags_wanted = by_place(expected.all());
    CHECK(download<Tag>(tags) == tags_wanted);
    CHECK(download<Tag>(on.tags()) == tags_wanted);
    auto const values_now = download<double>(values), values_wanted = by_column(expected.all());
    REQUIRE(values_now.size() == values_wanted.size());
    double difference = 0;
    for (std::size_t i = 0; i < values_now.size(); ++i)
      difference = std::max(difference, std::abs(values_now[i] - values_wanted[i]));
    CHECK(difference <= 1e-15);  // of numbers up to 1

    if constexpr (by_blocks)
      host = Elements(backend,
                      rows_of_blocks<E>(*now, ordered.cells[0], wanted, !changed, of_nodes), groups,
                      tags_wanted, node_rows, node_order<E>, wanted, changed ? &host : nullptr);
    else
      host = Elements(backend, all, groups, tags_wanted, node_rows, node_order<E>);
  }

  /// Any, of which rows have the same as long as they are there.
  Array<T> field_values(Index node_rows) {
    Random random(9);
    std::vector<T> list(at(node_stride * node_rows));
    for (T& x : list) x = static_cast<T>(random());
    return upload(backend, list);
  }
  /// Of the elements at some places.
  double sum_at(auto const& kernel, Index const* places, Index count) {
    auto const x = field_values(mesh.rows.count());
    auto sum = zeros<double>(backend, 1);
    add_sum_elements_at<groups>(backend, on, std::as_const(tags).data(), places, count,
                                mesh.rows.count(), kernel, sum.data(),
                                NodeField<T const, dim>{x.data()});
    return download<double>(sum)[0];
  }
  /// Of those of which the places meet a condition.
  double sum_if(auto const& kernel, auto const& meets) {
    auto const x = field_values(mesh.rows.count());
    auto sum = zeros<double>(backend, 1);
    add_sum_elements_if<groups>(backend, on, std::as_const(tags).data(), meets, mesh.rows.count(),
                                kernel, sum.data(), NodeField<T const, dim>{x.data()});
    return download<double>(sum)[0];
  }
  /// How many leaves of each group were divided or merged.
  std::vector<double> counts_of_gone(std::vector<Tag> const& tags_before) const {
    std::vector<double> counts(2);
    for (std::size_t i = 0; i < tags_before.size(); ++i) {
      Index const now = mesh.renumbered.cells[mesh.leaves_before[i]];
      if (now < 0 || !mesh.host->is_leaf(now)) counts[tags_before[i]] += 1;
    }
    return counts;
  }
  double energy(auto const& table) {
    auto const x = field_values(mesh.rows.count());
    return backend.template sum_elements<groups>(table, Energy{},
                                                 NodeField<T const, dim>{x.data()});
  }

  /// Loops over both tables give the same.
  void check_results(Index node_rows) {
    CHECK(on.patch_size() == host.patch_size());
    CHECK(std::ranges::equal(std::span<Index const>(on.patch_bounds()),
                             std::span<Index const>(host.patch_bounds())));
    CHECK(on.scratch_nodes() == host.scratch_nodes());
#if defined(__CUDACC__)
    REQUIRE(on.has_fans() == host.has_fans());
    if (auto const a = on.fan_view({}), b = host.fan_view({}); on.has_fans())
      CHECK(same_patches(backend, a, b, on.patch_count(),
                         detail::FanPlanner::first_unit(on.patch_count(), on.count(), a.capacity)));
    else
      CHECK(same_patches(backend, on.patch_view({}), host.patch_view({}), on.patch_count(),
                         on.count()));
#endif
    auto const x = field_values(node_rows);
    NodeField<T const, dim> const field{x.data()};
    auto const force = [&](Elements const& table) {
      auto f = zeros<T>(backend, at(node_stride * (node_rows + table.scratch_nodes())));
      backend.template accumulate<groups>(table, SpringForce<E::nodes, dim>{},
                                          NodeField<T, dim>{f.data()}, field);
      auto list = download<T>(f);
      list.resize(at(node_stride * node_rows));
      return list;
    };
    auto const f = force(on), wanted = force(host);
    T largest = 0, difference = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      largest = std::max(largest, std::abs(wanted[i]));
      difference = std::max(difference, std::abs(f[i] - wanted[i]));
    }
    CHECK(largest > T(1));
    CHECK(difference <= between_runs(64 * double{std::numeric_limits<T>::epsilon()}) * largest);
    CHECK(energy(on) == energy(host));
  }
};

}  // namespace pliant::test

#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/body/element_numbers_on.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/element_table.hpp>

#include "body/refined_mesh.hpp"
#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// What belongs to the elements of a mesh that is refined in a backend's memory, beside what the host makes of the same mesh.
namespace pliant::test {

/// Springs between all nodes of an element, of twice the stiffness in group 1.
template <int Nodes, int Dim>
struct SpringForce {
  static constexpr bool symmetric = true;
  template <int G, class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    V out = x;
    for (int k = 0; k < Dim; ++k) {
      auto sum = x(0, k);
      for (int a = 1; a < Nodes; ++a) sum = sum + x(a, k);
      for (int a = 0; a < Nodes; ++a) out(a, k) = S(G + 1) * (S(Nodes) * x(a, k) - sum);
    }
    return out;
  }
};
/// Weighs nodes by their places, so that no two orders of them give the same.
template <int Nodes, int Dim>
struct WeightedSquares {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    S sum = S(0);
    for (int k = 0; k < Dim; ++k)
      for (int a = 0; a < Nodes; ++a) sum = sum + S(G + 1) * S(a + 1) * x(a, k) * x(a, k);
    return sum;
  }
};

struct CountByGroup {
  static constexpr int counters = 2;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& x) const {
    Vector<std::remove_cvref_t<decltype(x(0, 0))>, 1> first;
    first[0] = x(0, 0);
    return first;
  }
  template <int G, class Values, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index, Values const&, Again const&,
                                 Tally const& tally) const {
    tally(G, 1.0);
  }
};

#if defined(__CUDACC__)
static_assert(TakesRows<CudaElements<double, 10>, Cuda<double>>);
static_assert(std::same_as<ElementListOn<Cuda<double>, 4>, CudaElementList<double, 4>>);

template <class B, class View>
bool same_patches(B const& backend, View const& one, View const& other, Index patches,
                  Index units) {
  auto const same = [&](auto const* a, auto const* b, Index count) {
    if ((a == nullptr) != (b == nullptr)) return false;
    if (a == nullptr) return true;
    auto const x = taken(backend, a, count), y = taken(backend, b, count);
    return std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return one.capacity.nodes == other.capacity.nodes && one.capacity.fans == other.capacity.fans &&
         one.capacity.slots == other.capacity.slots &&
         one.capacity.diagonals == other.capacity.diagonals &&
         same(one.units, other.units, units) &&
         same(one.nodes, other.nodes, patches * one.capacity.nodes) &&
         same(one.diagonals, other.diagonals, patches * one.capacity.diagonals);
}
#endif

/// Tables of a mesh that is refined: from rows in the backend's memory, and from connectivity of the host.
template <class B, Element E>
struct Tables {
  using T = typename B::scalar;
  using M = Mesh<E>;
  using Elements = typename B::template Elements<E::nodes>;
  template <class U>
  using Array = typename B::template Array<U>;
  static constexpr int groups = 2, dim = E::dim, width = row_width<Elements>;
  static constexpr bool by_blocks = PlansByBlocks<Elements, B>;

  RefinedMesh<B, E> mesh;
  B const& backend;
  std::vector<Tag> first_tags;       // by cell
  std::vector<double> first_values;  // by cell, then by column
  Elements on, host;
  Array<Tag> tags;
  Array<double> values;  // (2, elements)
  ElementNumbersOn<B> numbers;
  ElementBlocks blocks;
  std::vector<std::vector<Index>> leaves_of_blocks;

  Tables(B const& given, M const& of) : mesh(given, of), backend(mesh.backend) {
    Random random(3);
    auto const count = at(mesh.first.count());
    std::vector<Tag> own_tags;
    std::vector<double> own_values(2 * count);
    for (std::size_t c = 0; c < count; ++c) {
      first_tags.push_back(static_cast<Tag>(random.below(2)));
      for (int k = 0; k < 2; ++k) first_values.push_back(random());
    }
    for (Index const c : mesh.first.cells) own_tags.push_back(first_tags[at(c)]);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 2; ++k)
        own_values[k * count + i] = first_values[2 * at(mesh.first.cells[i]) + k];
    tags = upload(backend, own_tags);
    values = upload(backend, own_values);
    blocks.first = mesh.order.download_first_of_block();
    make({nullptr, width}, false);
  }

  void refine(std::vector<Index> const& marked) {
    auto const energy_before = energy(on);
    mesh.refine(marked);
    RefinedPlaces<B> const places(backend, mesh.tree.view(), mesh.order, mesh.refined.leaves);
    auto const gone = element_list(backend, on, std::as_const(tags).data(), places.go.data(),
                                   places.go_count, groups, mesh.rows.count());
    tags = inherited_values(backend, mesh.order, std::as_const(tags).data());
    values = inherited_values(backend, mesh.order, std::as_const(values).data(), 2);
    blocks = blocks_after_refinement(mesh.order, blocks.first);
    make(on.rows_of_nodes(), true);
    auto const made = element_list(backend, on, std::as_const(tags).data(), places.come.data(),
                                   places.come_count, groups, mesh.rows.count());
    CHECK(gone.count() == mesh.refined.leaves);
    CHECK(energy(made) > 0);
    CHECK(counts(gone) == counts_of_parents());
    CHECK(std::abs(energy(made) - energy(gone) - (energy(on) - energy_before)) <=
          1e-13 * energy_before);
  }

  Array<Index> rows(ElementRows const& before) {
    return element_rows<E, width>(backend, mesh.tree.view(), mesh.order, mesh.rows.of_node(),
                                  before);
  }
  Array<Tag> copy_of_tags() {
    auto copy = zeros<Tag>(backend, tags.size());
    detail::copy_values(backend, std::as_const(tags).data(), copy.data(), tags.size());
    return copy;
  }

  void make(ElementRows const& before, bool changed) {
    Index const node_rows = mesh.rows.count();
    on = elements_of_rows(backend, rows(before), groups, copy_of_tags(), node_rows, node_order<E>,
                          blocks, changed ? &on : nullptr);
    numbers.find(backend, mesh.tree, mesh.order);
    check_rows(node_rows, changed);
    check_results(node_rows);
  }

  /// Rows, numbers, tags and values are those that follow from the tree on the host.
  void check_rows(Index node_rows, bool changed) {
    std::vector<Index> divided, arriving;
    auto const cells = static_cast<Index>(mesh.host->cells().size());
    for (Index c = 0; c < cells; ++c)
      if (!mesh.host->is_leaf(c)) divided.push_back(c);
    auto const set = CellSet::range(0, cells).changed(
        divided, cells, [](Index c) { return c; }, arriving);
    Topology<M> const topology(mesh.host, {set});
    auto const ordered = elements_in_order(topology, mesh.first);
    auto wanted = ordered.blocks[0];
    REQUIRE(blocks.first == wanted.first);
    std::vector<std::vector<Index>> leaves;
    for (auto const& own : ordered.cells[0]) leaves.push_back(own->cells);
    if (changed) {
      for (std::size_t b = 0; b < leaves.size(); ++b)
        wanted.stays.push_back(leaves[b] == leaves_of_blocks[b] ? 1 : 0);
      CHECK(blocks.stays == wanted.stays);
      wanted.first_before = blocks.first_before;
    }
    leaves_of_blocks = leaves;

    auto const of_nodes = mesh.rows.download_all();
    auto const all = rows_of_blocks<E>(topology, ordered.cells[0], wanted, true, of_nodes);
    std::vector<Index> padded;
    for (auto const& row : all) {
      padded.insert(padded.end(), row.begin(), row.end());
      padded.resize(padded.size() + width - E::nodes, 0);
    }
    REQUIRE(on.count() == static_cast<Index>(all.size()));
    CHECK(taken(backend, on.rows_of_nodes().nodes, on.count() * width) == padded);

    ElementNumbers const expected(ordered.cells[0], wanted.first, set);
    REQUIRE(numbers.count() == on.count());
    CHECK(taken(backend, numbers.numbers(), numbers.count()) == expected.all());
    CHECK(taken(backend, numbers.cells(), numbers.count()) ==
          std::vector<Index>(set.begin(), set.end()));

    std::vector<Tag> tags_wanted;
    std::vector<double> values_wanted(2 * all.size());
    auto const leaves_now = mesh.leaves();
    for (std::size_t i = 0; i < leaves_now.size(); ++i) {
      Index const root = root_of(leaves_now[i]);
      tags_wanted.push_back(first_tags[at(root)]);
      for (std::size_t k = 0; k < 2; ++k)
        values_wanted[k * all.size() + i] = first_values[2 * at(root) + k];
    }
    CHECK(download<Tag>(tags) == tags_wanted);
    CHECK(download<Tag>(on.tags()) == tags_wanted);
    CHECK(download<double>(values) == values_wanted);

    if constexpr (by_blocks)
      host = Elements(
          backend, rows_of_blocks<E>(topology, ordered.cells[0], wanted, !changed, of_nodes),
          groups, tags_wanted, node_rows, node_order<E>, wanted, changed ? &host : nullptr);
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
  std::vector<double> counts(auto const& table) {
    auto const x = field_values(mesh.rows.count());
    auto counters = zeros<double>(backend, 2);
    backend.template visit<groups>(table, CountByGroup{}, counters,
                                   NodeField<T const, dim>{x.data()});
    return download<double>(counters);
  }
  /// How many leaves of each group were divided.
  std::vector<double> counts_of_parents() {
    std::vector<double> counts(2);
    for (auto const& leaf : taken(backend, mesh.refined.cells, mesh.refined.leaves))
      counts[first_tags[at(root_of(leaf.cell))]] += 1;
    return counts;
  }
  Index root_of(Index c) const {
    while (mesh.host->cell(c).parent >= 0) c = mesh.host->cell(c).parent;
    return c;
  }
  double energy(auto const& table) {
    auto const x = field_values(mesh.rows.count());
    return backend.template sum_elements<groups>(table, WeightedSquares<E::nodes, dim>{},
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
    CHECK(energy(element_list<E::nodes>(backend, rows({nullptr, width}), groups, copy_of_tags(),
                                        node_rows)) == Approx(energy(host)).epsilon(1e-13));
  }
};

}  // namespace pliant::test

#pragma once

#include "support/formulations.hpp"
#include "support/meshes.hpp"
#include "topology/trees_on.hpp"

// Cells of trees in a backend's memory get another degree as on the host.
namespace pliant::test::tree_on_conversion_suite {

/// Some leaves of one degree, ascending.
template <int Dim>
std::vector<Index> some_of_degree(Hierarchy<Dim> const& host, bool are_linear, std::size_t one_in,
                                  Random& random) {
  auto leaves = some_leaves(host, one_in, random);
  std::erase_if(leaves,
                [&](Index c) { return (host.cell(c).has == CellNodes::corners) != are_linear; });
  return leaves;
}
/// With some of them again, with leaves of the other degree, cells that are no leaves, and none.
template <int Dim>
std::vector<Index> with_others(Hierarchy<Dim> const& host, std::vector<Index> marked,
                               bool are_linear, Random& random) {
  auto more = some_of_degree(host, !are_linear, 3, random);
  for (Index c = 0; c < static_cast<Index>(host.cells().size()); ++c)
    if (!host.is_leaf(c)) more.push_back(c);
  for (Index const c : marked)
    if (random.below(3) == 0) more.push_back(c);
  marked.insert(marked.end(), more.begin(), more.end());
  marked.push_back(-1);
  random.shuffle(marked);
  return marked;
}

inline NodesOfKinds all_kinds(CellNodes has) {
  NodesOfKinds to;
  to.by_kind.fill(has);
  return to;
}

template <class B, int Dim>
Index raise_both(TreeBeside<B>& on, Hierarchy<Dim>& host, CellNodes has, Random& random) {
  auto const marked = some_of_degree(host, true, 3, random);
  auto const list = upload(on.backend, with_others(host, marked, true, random));
  std::vector<CellConversion> conversions;
  for (Index const c : marked) conversions.push_back({c, has});
  auto const done = on.tree.raise(list.data(), static_cast<Index>(list.size()), all_kinds(has));
  auto const wanted = host.raise(conversions).new_nodes;
  REQUIRE(done.raised == static_cast<Index>(marked.size()));
  CHECK(on.taken(done.cells, done.raised) == marked);
  REQUIRE(done.new_nodes == static_cast<Index>(wanted.size()));
  auto const made = on.taken(done.nodes, done.new_nodes);
  int wrong = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    wrong += made[k].node != wanted[k].node;
    wrong += made[k].had != CellNodes::corners;
    auto const weights =
        detail::shape_weights<Dim>(host.cell(made[k].cell).kind, made[k].had,
                                   host.tree().nodes_of(made[k].cell), made[k].place);
    wrong += weights.size() != wanted[k].parents.size();
    for (std::size_t i = 0; i < weights.size() && i < wanted[k].parents.size(); ++i)
      wrong += weights[i] != wanted[k].parents[i];
  }
  CHECK(wrong == 0);
  check_same(on.tree, host);
  return done.raised;
}

template <class B, int Dim>
Index lower_both(TreeBeside<B>& on, Hierarchy<Dim>& host, std::size_t one_in, Random& random) {
  auto const marked = some_of_degree(host, false, one_in, random);
  auto const list = upload(on.backend, with_others(host, marked, false, random));
  auto const before = on.tree.sizes();
  auto const done = on.tree.lower(list.data(), static_cast<Index>(list.size()));
  auto const wanted = host.merge({}, marked);
  REQUIRE(done.lowered == static_cast<Index>(marked.size()));
  CHECK(done.merged == 0);
  check_same(on.tree, host);
  if (marked.empty()) return 0;
  CHECK(on.taken(done.lowered_cells, done.lowered) == marked);
  CHECK(done.now.cells == before.cells);
  CHECK(done.now.edges == before.edges);
  auto const numbers = on.taken(done.nodes, before.nodes - done.staying.nodes);
  int wrong = 0;
  for (Index k = 0; k < static_cast<Index>(numbers.size()); ++k)
    wrong +=
        numbers[static_cast<std::size_t>(k)] != wanted.renumbered.nodes[done.staying.nodes + k];
  CHECK(wrong == 0);
  return done.lowered;
}

/// Changes at random, here and on the host, some kept together, some taken back; then lowers and merges all.
template <class B, class M>
void check_conversions(B const& backend, M const& mesh, CellNodes has, int rounds) {
  Hierarchy<M::dim> host(mesh);
  TreeBeside<B> on(backend, host);
  HangingNodesOn<M::dim, B> hanging(backend), followed(backend);
  auto const first = host;
  auto kept = host;
  Random random(6);
  Index raised = 0, lowered = 0, merged = 0, taken_back = 0;
  for (int round = 0; round < rounds; ++round) {
    auto const check = [&](auto const& find) { check_hanging(backend, host, find); };
    auto const check_after = [&](auto const& done) {
      check([&](Index const* rows) { return followed.rows_after(on.tree, done, rows); });
    };
    auto const next = round < 2 ? round : static_cast<int>(random.below(5));
    if (next == 0) {
      check_after(refine_both(on, host, some_leaves(host, host.leaf_count() / 6 + 1, random)));
    } else if (next == 1 || next == 4) {
      raised += raise_both(on, host, has, random);
    } else if (next == 2) {
      lowered += lower_both(on, host, 3, random);
    } else {
      auto const done = coarsen_both(on, host, host.leaves(), random);
      check_after(done);
      merged += done.merged;
    }
    check([&](Index const* rows) { return hanging.rows(on.tree, rows); });
    if (round % 4 == 3) {
      on.tree.take_back();
      host = kept;
      followed = HangingNodesOn<M::dim, B>(backend);
      check_same(on.tree, host);
      ++taken_back;
    } else if (random.below(3) > 0) {
      on.tree.keep();
      kept = host;
    }
  }
  CHECK(raised > 3);
  CHECK(lowered > 3);
  CHECK(merged > 0);
  CHECK(taken_back > 0);
  lower_both(on, host, 1, random);
  while (coarsen_both(on, host, host.leaves(), random).merged > 0) {
  }
  if (first.tree().lists().quadratic_leaves == 0) check_same(on.tree, first);
}

TEST_CASE("cells get another degree in a backend's memory", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    check_conversions(backend, regular_mesh<Tri3>(5), CellNodes::edges, 40);
    check_conversions(backend, regular_mesh<Quad4>(5), CellNodes::edges, 40);
    check_conversions(backend, regular_mesh<Quad4>(5), CellNodes::all, 40);
    check_conversions(backend, regular_mesh<Tet4>(2), CellNodes::edges, 28);
    check_conversions(backend, regular_mesh<Hex8>(3), CellNodes::all, 28);
    check_conversions(backend, mesh::raised<Tet10>(regular_mesh<Tet4>(2)), CellNodes::edges, 28);
    check_conversions(backend, mesh::raised<Quad9>(regular_mesh<Quad4>(5)), CellNodes::all, 40);
  });
}

TEST_CASE("a tree whose cells would get too many nodes is as it was", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Hierarchy<3> host(regular_mesh<Tet4>(2));
    TreeBeside<B> on(backend, host);
    std::vector<CellConversion> const conversions{{3, CellNodes::edges}, {7, CellNodes::edges}};
    auto raised = host;
    auto const more = raised.raise(conversions).new_nodes.size();
    RefinementLimits limits{.nodes = host.points().size() + more - 1};
    auto const list = upload(backend, std::vector<Index>{3, 7});
    auto const says_how_many = says("takes " + std::to_string(host.points().size() + more));
    CHECK_THROWS_WITH(on.tree.raise(list.data(), 2, all_kinds(CellNodes::edges), limits),
                      says_how_many);
    CHECK_THROWS_WITH(host.raise(conversions, limits), says_how_many);
    check_same(on.tree, host);
    CHECK(!on.tree.mixes_degrees());
    ++limits.nodes;
    CHECK(on.tree.raise(list.data(), 2, all_kinds(CellNodes::edges), limits).raised == 2);
    check_same(on.tree, raised);
    CHECK(on.tree.raise(list.data(), 2, all_kinds(CellNodes::edges)).raised == 0);
    NodesOfKinds others;
    others.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] = CellNodes::all;
    CHECK(on.tree.raise(upload(backend, std::vector<Index>{1, 2}).data(), 2, others).raised == 0);
    CHECK(on.tree.mixes_degrees());
    on.tree.take_back();
    check_same(on.tree, host);
    CHECK(!on.tree.mixes_degrees());
  });
}

}  // namespace pliant::test::tree_on_conversion_suite

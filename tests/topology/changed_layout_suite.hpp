#pragma once

#include <sstream>

#include "support/keeps_trees.hpp"
#include "support/repeatable.hpp"
#include "topology/random_changes.hpp"

// What changes of the mesh make of a body's layout, step by step, is what making it anew gives.
namespace pliant::test::changed_layout_suite {

/// Masses, numbering and places of a layout are those of one made anew from the same topology.
template <class TheBody>
void check_layout(TheBody& body) {
  auto const& parts = body.parts();
  auto const& own = parts.layout;
  using T = typename TheBody::scalar;
  typename TheBody::layout_type const anew(parts.backend, *parts.state.topology, parts.material,
                                           parts.groups, &own, own.node_rows());
  CHECK(own.own_masses() == anew.own_masses());
  CHECK(own.mass_list() == anew.mass_list());
  CHECK(own.rows == own.node_rows().count());
  auto const mass = download<T>(own.mass);
  Index nodes = 0;
  for (Index row = 0; row < own.rows; ++row)
    if (Index const node = own.user_of(row); node >= 0) {
      CHECK(own.internal_of(node) == row);
      ++nodes;
    } else {
      CHECK(mass[static_cast<std::size_t>(row)] == 0);
    }
  CHECK(nodes == own.nodes());
  CHECK(download<T>(own.mass) == download<T>(anew.mass));
  CHECK(download<T>(own.rest) == download<T>(anew.rest));
  parts.for_each_type([&](auto const& table, auto const&) {
    auto const& all = std::get<std::remove_cvref_t<decltype(table)>>(anew.tables).user_elements();
    CHECK(table.user_elements() == all);
    for (std::size_t e = 0; e < all.size(); e += 7)
      CHECK(table.user_element(static_cast<Index>(e)) == all[e]);
  });
}

/// Masses have the bits of those of a body that was made on the mesh as it is, if one can be: its slaves may not have
/// negative weights. Whether there were some to compare.
template <class P, class TheBody>
bool check_masses(TheBody& body) {
  for (auto const& slave : body.mesh().slaves)
    for (auto const& [master, weight] : slave.masters)
      if (weight < 0) return false;
  auto const fresh = P::body(body.parts().backend, body.mesh());
  CHECK(body.parts().layout.own_masses() == fresh.parts().layout.own_masses());
  CHECK(body.parts().layout.mass_list() == fresh.parts().layout.mass_list());
  return !body.mesh().slaves.empty();
}

/// The energy that the last change added is in the ledger.
template <class TheBody>
void check_ledger(TheBody& body, double before, std::size_t entries) {
  double const now = strain_energy(body);
  if (ledger(body).size() == entries) return;
  CHECK(ledger(body).back().strain_energy ==
        Approx(now - before).epsilon(1e-9).margin(1e-12 * (now + before)));
}

TEST_CASE("a layout that was changed is what a new one would be", "[topology]") {
  on_each_backend<DoubleBackends>([&]<class B>(B const& backend) {
    auto const run = [&]<class P>(P) {
      auto body = P::body(backend), restored = P::body(backend);
      set_mesh_limits(body, {.nodes = P::most_nodes});
      body.clamp(body.mesh().boundary("left"));
      Random random(7);
      int compared = 0;
      for (int i = 0; i < 60; ++i) {
        auto u = body.mesh().nodes;
        for (auto& row : u)
          for (double& x : row) x = 1e-5 * static_cast<double>(random.below(100));
        body.set_displacements(u);
        double const before = strain_energy(body);
        auto const entries = ledger(body).size();
        try {
          change<P>(body, random);
          check_ledger(body, before, entries);
        } catch (Error const&) {
          undo(body);
        }
        check_layout(body);
        compared += check_masses<P>(body);
        if (i % 5 != 0) continue;
        std::stringstream file;
        body.save(file);
        restored.load(file);
        CHECK(restored.parts().layout.own_masses() == body.parts().layout.own_masses());
        CHECK(restored.parts().layout.mass_list() == body.parts().layout.mass_list());
        auto const forces = body.forces(), again = restored.forces();
        double largest = 0, apart = 0;
        for (std::size_t n = 0; n < forces.size(); ++n)
          for (std::size_t k = 0; k < forces[n].size(); ++k) {
            largest = std::max(largest, std::abs(forces[n][k]));
            apart = std::max(apart, std::abs(forces[n][k] - again[n][k]));
          }
        CHECK(largest > 0);
        CHECK(apart <= between_runs(1e-12) * largest);
      }
      CHECK(compared > 5);
    };
    run(ChangingPlane{});
    run(ChangingSolid{});
  });
}

TEST_CASE("energies of elements whose nodes hang at other masters are in the ledger",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Mesh<Tri3> const mesh{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{{0, 1, 2}, {0, 2, 3}}}};
    Body body{backend, mesh, soft, Group<Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>>{}};
    // The elements in the upper triangle, those inside of it, whose nodes are new, and those in the lower one.
    auto const where = [&](bool upper, bool inside) {
      std::vector<Index> found;
      auto const& elements = body.mesh().template elements<Tri3>();
      for (std::size_t e = 0; e < elements.size(); ++e) {
        auto const centre = mean_of_nodes(*body.parts().state.topology, elements[e]);
        bool const is_new = std::ranges::all_of(elements[e], [](Index node) { return node > 3; });
        if (upper == (centre[1] > centre[0]) && (!inside || is_new))
          found.push_back(static_cast<Index>(e));
      }
      return std::vector<std::vector<Index>>{found};
    };
    refine(body, {{0, 1}});
    refine(body, where(true, true));
    REQUIRE(body.mesh().slaves.size() == 3);  // the middles of the edges of the element inside
    Random random(2);
    body.set_displacements(random.field<2>(body.mesh().nodes.size(), 1e-3));
    double const before = strain_energy(body);
    auto const entries = ledger(body).size();

    // Two of them hang on a node that begins to hang itself, in elements that have not that node.
    REQUIRE(coarsen(body, where(false, false)).merged == 1);

    REQUIRE(ledger(body).size() == entries + 1);
    CHECK(std::abs(strain_energy(body) - before) > 0.01 * before);
    check_ledger(body, before, entries);
    check_layout(body);
  });
}

/// By the new number of each element the old one of those that stay, -1 for others.
template <class M>
std::vector<Index> old_elements(TopologyChange<M> const& change) {
  std::vector<Index> old;
  for (auto const& origin : change.transfer.origins())
    for (Index k = 0; k < origin.count; ++k)
      old.push_back(origin.child == Transfer<M::dim>::Origin::same ? origin.element + k : -1);
  return old;
}

/// By the internal number the user's one.
template <class M>
std::vector<Index> numbers(OrderedElements<1> const& ordered, Topology<M> const& topology) {
  return ElementNumbers(ordered.cells[0], ordered.blocks[0].first, topology.cells[0]).all();
}

/// Rows of nodes in random changes of a mesh, which the host makes or the backend.
template <class B>
void check_rows(B const& backend, bool on_host) {
  Body body{backend, mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {10, 10, 10}}), soft,
            Group<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>>{}};
  if (on_host) change_on_host(body);
  using Own = typename decltype(body)::mesh_type;
  auto const initial = body.parts().layout.rows;
  NodeRows rows = body.parts().layout.node_rows();
  Index most_nodes = 0, most_rows = 0;
  int kept = 0, moved = 0, gone = 0;
  std::optional<Transfer<3>> transfer;
  body.on_change([&](TopologyChange<Own> const& made) { transfer.emplace(made.transfer); });
  auto const compare = [&] {
    auto const& now = body.parts().layout.node_rows();
    for (Index old = 0; transfer && old < transfer->old_nodes(); ++old) {
      Index const node = transfer->renumbered(old);
      if (node < 0) {
        ++gone;
        continue;
      }
      bool const same = now.of_node[static_cast<std::size_t>(node)] ==
                        rows.of_node[static_cast<std::size_t>(old)];
      ++(same ? kept : moved);
    }
    transfer.reset();
    rows = now;
    most_nodes = std::max(most_nodes, body.nodes());
    most_rows = std::max(most_rows, body.parts().layout.rows);
  };
  Random random(11);
  for (int i = 0; i < 30; ++i) {
    std::vector<std::vector<Index>> marked(1);
    auto const levels = refinement_levels<Tet4>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (i % 3 == 2 ? levels[e] > 0 : levels[e] < 2 && random.below(200) == 0)
        marked[0].push_back(static_cast<Index>(e));
    if (i % 3 == 2)
      coarsen(body, marked);
    else
      refine(body, marked);
    compare();
  }
  CHECK(kept > 1000);
  CHECK(moved == 0);
  CHECK(gone > 100);
  // What is reserved is what was needed at once, in pages; in the end the host gives all of it back, and a backend keeps it.
  CHECK(most_rows < most_nodes + 8 * NodeRows::page);
  auto const reserved = body.parts().layout.rows;
  for (int i = 0; i < 3; ++i) {
    std::vector<std::vector<Index>> all(1);
    auto const levels = refinement_levels<Tet4>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] > 0) all[0].push_back(static_cast<Index>(e));
    coarsen(body, all);
    compare();
  }
  auto const left = body.parts().layout.rows;
  CHECK((on_host ? left < initial + NodeRows::page : left == reserved));
}

TEST_CASE("nodes keep their rows while they are there", "[topology]") {
  on_each_backend<DoubleBackends>([](auto const& backend) { check_rows(backend, true); });
  on_each_backend<KeepingBackends>([](auto const& backend) { check_rows(backend, false); });
}

TEST_CASE("blocks that are said to stay have the elements that they had", "[topology]") {
  using Own = Mesh<Tet4>;
  Body body{Reference<double>{}, mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {12, 12, 12}}), soft,
            Group<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>>{}};
  CellOrder const first = *body.parts().layout.first_order;
  int stay = 0, change = 0;
  body.on_change([&](TopologyChange<Own> const& made) {
    if (!made.before.tree) return;
    auto const before = elements_in_order(made.before, first);
    auto const changed =
        changed_blocks(first, places_of_families(made.after, first, made.transfer));
    OrderBefore<1> const known{{before.cells[0]}, changed};
    auto const after = elements_in_order(made.after, first, &known);
    auto const& [now, then] = std::pair(after.blocks[0], before.blocks[0]);
    auto const old = old_elements(made), new_numbers = numbers(after, made.after),
               old_numbers = numbers(before, made.before);
    REQUIRE(now.first.size() == then.first.size());
    for (std::size_t b = 0; b < now.stays.size(); ++b) {
      bool same = now.first[b + 1] - now.first[b] == then.first[b + 1] - then.first[b];
      for (Index k = 0; same && k < now.first[b + 1] - now.first[b]; ++k)
        same = old[static_cast<std::size_t>(
                   new_numbers[static_cast<std::size_t>(now.first[b] + k)])] ==
               old_numbers[static_cast<std::size_t>(then.first[b] + k)];
      CHECK((now.stays[b] != 0) == same);
      ++(same ? stay : change);
    }
  });
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    std::vector<Index> marked;
    auto const levels = refinement_levels<Tet4>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (i % 3 == 2 ? levels[e] > 0 && random.below(8) != 0 : random.below(800) == 0)
        marked.push_back(static_cast<Index>(e));
    if (i % 3 == 2)
      coarsen(body, {marked});
    else
      refine(body, {marked});
    check_layout(body);
  }
  CHECK(stay > 0);
  CHECK(change > 0);
}

TEST_CASE("a table takes blocks that stay from the one before it", "[topology]") {
  // Blocks of two, three, no and one elements of two nodes; the second and the last are new.
  ElementBlocks blocks{.first = {0, 2, 5, 5, 6}, .stays = {1, 0, 1, 0}};
  blocks.first_before = {1, 3, 4, 4, 7};
  std::vector<Index> const before{9, 9, 0, 1, 1, 2, 5, 5, 6, 6, 7, 7, 8, 8};
  std::vector<Index> const rows{70, 71, 72, 73, 74, 75, 76, 77};
  auto const sources = detail::sources_of(blocks);
  std::vector<Index> table(3 * 6, -1),
      again = table;  // rows of three, the last of which is padding
  std::vector<Index> padded;
  for (std::size_t e = 0; e < before.size() / 2; ++e)
    padded.insert(padded.end(), {before[2 * e], before[2 * e + 1], -1});
  detail::CarryConnectivity<2, 3> carry{blocks.first.data(), sources.data(), 4,
                                        padded.data(),       rows.data(),    table.data()};
  for (Index e = 0; e < 6; ++e) carry(e);
  CHECK(table ==
        std::vector<Index>{0, 1, -1, 1, 2, -1, 70, 71, -1, 72, 73, -1, 74, 75, -1, 76, 77, -1});
  carry.to = again.data();
  for (Index block = 0; block < 4; ++block)
    for (Index e = blocks.first[static_cast<std::size_t>(block)];
         e < blocks.first[static_cast<std::size_t>(block) + 1]; ++e)
      carry.carry(block, e);
  CHECK(again == table);
}

}  // namespace pliant::test::changed_layout_suite

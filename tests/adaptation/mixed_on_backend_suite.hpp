#pragma once

#include <sstream>

#include <pliant/mesh/joined.hpp>

#include "adaptation/both_types.hpp"

// Bodies of several element types whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::mixed_on_backend_suite {
using namespace two_bodies;

/// Tetrahedra, and hexahedra beside them, which share no nodes.
inline Mesh<Tet4, Hex8> solid_mesh() {
  auto const tets = mesh::with_types<Tet4, Hex8>(distorted_mesh<Tet4>(2));
  auto const hexes = mesh::with_types<Tet4, Hex8>(mesh::moved(distorted_mesh<Hex8>(3), {2, 0, 0}));
  return mesh::joined<Tet4, Hex8>({tets, hexes}).mesh;
}

TEST_CASE("meshes of several types that a body's backend changes are those that the host makes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_both_types(backend, mixed_mesh(6), 6);
    check_both_types(backend, solid_mesh(), 8);
  });
}

TEST_CASE("a mesh of several types of which one has no elements changes on a backend",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    BothTypes<Tri3, Quad4, B> triangles(backend,
                                        mesh::with_types<Tri3, Quad4>(distorted_mesh<Tri3>(4))),
        quads(backend, mesh::with_types<Tri3, Quad4>(distorted_mesh<Quad4>(4)));
    for (auto* both : {&triangles, &quads}) {
      both->refine_one_in(5);
      both->refine_one_in(5);
      CHECK(both->coarsen_all_but_one_in(12) > 0);
      both->check_all();
    }
  });
}

TEST_CASE("the host makes few changes of a mesh of several types again", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    BothTypes<Tri3, Quad4, B> both(backend, mixed_mesh(12));
    auto const change = [&](Marks const& refined, Marks const& merged) {
      for (auto* one : {&both.body, &both.host}) {
        refine(*one, refined);
        if (!merged.empty()) CHECK(coarsen(*one, merged).merged > 0);
      }
      REQUIRE(!both.body.parts().topology_on->is_far_ahead());
      both.check_place();
      both.check_all();
    };
    change({{}, {5}}, {});  // of the first mesh, which has no tree
    auto const levels = refinement_levels<Quad4>(both.host);
    Marks children{{}, {}};
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] > 0) children[1].push_back(static_cast<Index>(e));
    change({{3}, {}}, children);
  });
}

TEST_CASE("a backend takes a mesh up again some changes behind the last that the host had to make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    BothTypes<Tri3, Quad4, B> both(backend, mixed_mesh(6));
    auto const refine_both = [&](bool is_there) {
      auto const marked = random_marks(both.host, both.random, 12);
      CHECK(refine(both.body, marked, 3).refined == refine(both.host, marked, 3).refined);
      CHECK(is_on_backend(both.body) == is_there);
      both.check_all();
    };
    refine_both(true);
    both.body.on_backend_change([](auto const&) {});  // so that the host splits
    for (int turn = 0; turn < 2; ++turn) {
      std::size_t split_in_all = 0;
      for (auto* one : {&both.body, &both.host}) split_in_all += split(*one, {{}, {0}}).split;
      CHECK(split_in_all == 2);
      CHECK(!is_on_backend(both.body));
      for (int k = 0; k < HostChanges::some; ++k) refine_both(false);
      refine_both(true);
      refine_both(true);
    }
    CHECK(!is_on_backend(both.host));
  });
}

TEST_CASE("elements that others were split into are refined and merged on a backend",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    BothTypes<Tri3, Quad4, B> both(backend, mixed_mesh(6));
    std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
    bool is_told = false;
    both.host.on_backend_change([&](auto const& change) {
      if (std::exchange(is_told, true)) return;
      std::vector<typename B::template Array<int>> colours;
      for (std::size_t const type : {0u, 1u}) {
        std::vector<int> own(at(change.elements_before(type)), -1);
        for (std::size_t e = 0; type == 1 && e < own.size(); ++e) own[e] = static_cast<int>(e);
        colours.push_back(upload(backend, own));
      }
      CHECK_THROWS_WITH(change.carry_elements(colours[0]), says("give the values of all types"));
      CHECK_THROWS_WITH(change.carry_elements(colours[0], 1),
                        says("give the array from before it"));
      auto const triangles = download<int>(change.carry_elements(colours, 0));
      for (int quad : {0, 1, 2}) CHECK(std::ranges::count(triangles, quad) == 2);
      CHECK(std::ranges::count(triangles, -1) + 6 == std::ssize(triangles));
    });
    auto const is_split = split(both.host, {{}, {0, 1, 2}}, {.triangles = 2}).split +
                          split(both.host, {{}, {1}}, {.triangles = 4}).split;
    REQUIRE(is_split == 4);
    CHECK(is_told);
    both.host.save(saved);
    both.body.load(saved);  // which its backend may change
    for (int round = 0; round < 2; ++round) {
      both.refine_one_in(4);
      both.check_all();
      CHECK(both.coarsen_all_but_one_in(10) > 0);
      both.check_all();
    }
  });
}

}  // namespace pliant::test::mixed_on_backend_suite

#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <sstream>
#include <thread>

#include <pliant/body/compare.hpp>

#include "adaptation/changes_on_backend.hpp"
#include "support/spring.hpp"
#include "topology/tree_states.hpp"

// Bodies that are refined in their backend's memory, beside bodies that are refined on the host.
namespace pliant::test::refinement_on_backend_suite {
using namespace two_bodies;

TEST_CASE("a body that is refined in its backend's memory is the one that the host would make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_rounds<Formulation<Tri3, Gauss<1>, NeoHookean>>(backend, 6, 6, 4);
    check_rounds<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend, 6, 6, 4);
    check_rounds<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend, 4, 20, 3);
    check_rounds<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, 4, 20, 3);
  });
  check_rounds<Formulation<Tet4, Gauss<1>, NeoHookean>>(KeepingFloat{}, 4, 20, 2);
}

TEST_CASE("a body that is coarsened in its backend's memory is the one that the host would make",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_both_ways<Formulation<Tri3, Gauss<1>, NeoHookean>>(backend, 6, 5, 3);
    check_both_ways<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend, 6, 5, 2);
    check_both_ways<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend, 3, 12, 2);
    check_both_ways<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, 3, 8, 2);
    check_both_ways<Formulation<Wedge6, Gauss<2>, NeoHookean>>(backend, 3, 12, 1);
  });
  check_both_ways<Formulation<Tri3, Gauss<1>, NeoHookean>>(KeepingFloat{}, 6, 5, 2);
}

/// Marked elements of one type, in the backend's memory.
template <class TheBody>
auto there(TheBody& body, std::vector<Index> const& marked, auto const& f) {
  auto const list = upload(body.parts().backend, marked);
  return f(body, std::vector{ElementsThere{list.data(), static_cast<Index>(marked.size())}});
}

TEST_CASE("elements are marked in the backend's memory", "[adaptation]") {
  auto const refine_there = [](auto& body, auto const& lists) { return refine(body, lists, 3); };
  auto const coarsen_there = [](auto& body, auto const& lists) { return coarsen(body, lists); };
  on_each_backend<KeepingBackends>([&]<class B>(B const& backend) {
    using F = Formulation<Tet4, Gauss<1>, NeoHookean>;
    for (bool const on_host : {false, true}) {
      CAPTURE(on_host);
      auto body = body_of<F>(backend, on_host, 3), same = body_of<F>(backend, true, 3);
      Random random(4);
      CHECK_THROWS_WITH(there(body, {count(body)}, coarsen_there), says("coarsen: there is no"));
      for (int round = 0; round < 3; ++round) {
        auto const marked = some(same, 9, random);
        auto const done = there(body, marked, refine_there);
        auto const wanted = refine(same, {marked}, 3);
        CHECK(done.refined == wanted.refined);
        CHECK(done.new_nodes == wanted.new_nodes);
        std::vector<Index> all;
        for (Index e = 0; e < count(same); ++e)
          if (random.below(6) > 0) all.push_back(e);
        auto const merged = there(body, all, coarsen_there);
        auto const wanted_merged = coarsen(same, {all});
        CHECK(merged.merged == wanted_merged.merged);
        CHECK(merged.gone_nodes == wanted_merged.gone_nodes);
      }
      CHECK(is_on_backend(body) != on_host);
      CHECK(body.mesh().tables == same.mesh().tables);
      CHECK(there(body, {}, refine_there).refined == 0);
      CHECK_THROWS_WITH(there(body, {0, -3}, refine_there),
                        says("refine: there is no Tet4 element -3"));
      CHECK_THROWS_WITH(there(body, {count(body)}, coarsen_there), says("coarsen: there is no"));
      CHECK(body.mesh().tables == same.mesh().tables);
    }
  });
}

TEST_CASE("lists in the backend's memory have an address and a length", "[adaptation]") {
  auto body = body_of<Formulation<Tri3, Gauss<1>, NeoHookean>>(KeepingFloat{}, false, 3);
  CHECK_THROWS_WITH(
      refine(body, std::vector{ElementsThere{nullptr, 3}}),
      says("refine: got a list of 3 marked elements in the backend's memory at null"));
  CHECK_THROWS_WITH(coarsen(body, std::vector{ElementsThere{nullptr, -1}}),
                    says("coarsen: got a list of -1 marked elements"));
  CHECK_THROWS_WITH(refine(body, std::vector<ElementsThere>(2)),
                    says("for 2 element types, but the mesh has 1"));
  CHECK(refine(body, std::vector<ElementsThere>(1)).refined == 0);
}

TEST_CASE("listeners are told of elements that were marked in the backend's memory",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Formulation<Tri3, Gauss<1>, NeoHookean>, B> both(backend, 5);
    std::size_t told = 0, wanted = 0;
    both.body.on_change([&](auto const& change) { told += change.transfer.families().size(); });
    both.host.on_change([&](auto const& change) { wanted += change.transfer.families().size(); });
    both.refine_one_in(4);
    auto const marked = some(both.host, 3, both.random);
    there(both.body, marked, [](auto& body, auto const& lists) { return refine(body, lists); });
    refine(both.host, {marked});
    both.check_place();
    CHECK(told == wanted);
    both.check_all();
  });
}

TEST_CASE("a refinement is refused where single precision cannot hold the masses behind it",
          "[adaptation]") {
  Mesh<Tri3> mesh;
  mesh.nodes = {{0, 0}, {1, 0}, {0, 1}};
  mesh.elements<Tri3>() = {{0, 1, 2}};
  // A node has 1.4 times the least mass, and a corner a quarter of that when the element is refined, which is rounded to none.
  double const least = std::numeric_limits<float>::denorm_min();
  Body body{KeepingFloat{}, mesh, Elastic{5.2, 0.3, 6 * 1.4 * least},
            Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{}};
  CHECK_THROWS_WITH(refine(body, {{0}}), says("32 bits cannot hold the mass of a node"));
  CHECK(body.mesh().nodes.size() == 3);
  CHECK(refinement_levels<Tri3>(body) == std::vector<int>{0});
}

template <class E>
using Graded = Formulation<E, Gauss<1>, PerElement<NeoHookean>::law>;

TEST_CASE("elements keep the values that their laws read where a body's backend changes its mesh",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_both_ways<Graded<Tri3>>(backend, 5, 5, 2);
    check_rounds<Graded<Tet4>>(backend, 3, 12, 2);
  });
}

TEST_CASE("force terms are made anew where a body's backend changes its mesh", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    TwoBodies<F, B> both(backend, 6);
    int made = 0;
    bool fails = false;
    auto const springs = [&](B const& b, NodeRows const& rows) {
      if (fails) throw std::runtime_error("no springs");
      ++made;
      auto const last = static_cast<Index>(rows.of_node.size()) - 1;
      return std::make_unique<ConnectedTerm<B, Spring>>(
          b, std::vector<std::array<Index, 2>>{{rows.of_node[3], rows.of_node[at(last)]}},
          Spring<double>{20}, rows.count());
    };
    both.body.add(springs);
    both.host.add(springs);
    both.refine_one_in(5);
    both.coarsen_all_but_one_in(6);
    CHECK(made == 6);
    both.check_all();
    auto const nodes = both.body.nodes();
    auto const forces = both.body.forces();
    fails = true;
    CHECK_THROWS_AS(refine(both.body, {{0, 1}}), std::runtime_error);
    fails = false;
    CHECK(both.body.nodes() == nodes);
    CHECK(largest_difference(both.body.forces(), forces) <= 100 * both.rounding);
    both.refine_one_in(5);
    both.check_all();
  });
}

TEST_CASE("loads on nodes that a body's backend takes away go to those that stay", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Formulation<Tri3, Gauss<1>, NeoHookean>, B> both(backend, 6);
    both.refine_one_in(3);
    auto const loads = both.random.template field<2>(at(both.body.nodes()), 1);
    both.body.set_loads(loads);
    both.host.set_loads(loads);
    CHECK(both.coarsen_all_but_one_in(9) > 4);
    auto const left = nodal_loads_of(both.body.parts());
    CHECK(largest_difference(left, nodal_loads_of(both.host.parts())) < 10 * both.rounding);
    Point<2> sum{};
    for (auto const& force : loads)
      for (std::size_t k = 0; k < 2; ++k) sum[k] += force[k];
    for (auto const& force : left)
      for (std::size_t k = 0; k < 2; ++k) sum[k] -= force[k];
    CHECK(std::abs(sum[0]) + std::abs(sum[1]) < 1000 * both.rounding);
  });
}

TEST_CASE("where values are set by place, the host changes the mesh", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    Body body{backend, distorted_mesh<Tri3>(3), soft,
              Group<Graded<Tri3>>{.values_at = [](Point<2> const& x) {
                return std::array<double, 2>{1 + x[0], 2 + x[1]};
              }}};
    refine(body, {{0, 1}});
    CHECK(!is_on_backend(body));
  });
}

TEST_CASE("rules refine a body in its backend's memory as on the host", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    double const rounding = std::numeric_limits<double>::epsilon();
    for (int const most : {1, 2}) {
      auto body = body_of<F>(backend, false, 6), host = body_of<F>(backend, true, 6);
      Adaptation adapt{when<F>(ForceIntensity<>{}).bulk(0.4).budget(9).refine({.max_level = most}),
                       when<Stiffer<F>>(ForceIntensity<>{}).above(1e9).refine({.max_level = most})};
      auto other = adapt;
      for (int round = 0; round < 5; ++round) {
        adapt.now(body);
        other.now(host);
        REQUIRE(is_on_backend(body));
        REQUIRE(!is_on_backend(host));
        CHECK(count(body) == count(host));
      }
      check_same(body, host, rounding);
      auto const levels = refinement_levels<Tri3>(body);
      CHECK(*std::ranges::max_element(levels) == most);
    }
  });
}

TEST_CASE("rules refine and coarsen a body at once in its backend's memory as on the host",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    TwoBodies<F, B> both(backend, 6);
    std::size_t merged = 0;
    for (int round = 0; round < 4; ++round) {
      both.refine_one_in(4);
      // Some of the families to merge lie beside what is refined.
      auto const marked = both.refine_one_in_and_coarsen(12);
      auto const plan = plan_change(both.host.parts(), marked, 3);
      REQUIRE(plan);
      commit(both.host.parts(), *plan);
      auto const done = detail::change_on_backend(
          both.body.parts(), {.refine = marked.refine, .coarsen = marked.coarsen}, 3);
      REQUIRE(done);
      CHECK(done->counts.refined == plan->counts.refined);
      CHECK(done->counts.coarsened == plan->counts.coarsened);
      merged += done->counts.coarsened;
      both.check_place();
      both.check_all();
    }
    CHECK(merged > 20);
  });
}

TEST_CASE("what moves as one goes on to the bit where it is refined on a backend", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tet4, Gauss<1>, NeoHookean>;
    auto body = body_of<F>(backend, false, 3);
    Point<3> const velocity{0.1, -0.7, 1.0 / 3};
    body.set_velocities(std::vector<Point<3>>(at(body.nodes()), velocity));
    // Held nodes were stopped.
    auto free = Body{backend, distorted_mesh<Tet4>(3), soft, Group<F>{}};
    free.set_velocities(std::vector<Point<3>>(at(free.nodes()), velocity));
    free.set_displacements(std::vector<Point<3>>(at(free.nodes()), velocity));
    Random random(9);
    for (int round = 0; round < 4; ++round) refine(free, {some(free, 20, random)});
    REQUIRE(is_on_backend(free));
    int wrong = 0;
    for (auto const& v : free.velocities()) wrong += v != velocity;
    for (auto const& u : free.displacements()) wrong += u != velocity;
    CHECK(wrong == 0);
  });
}

TEST_CASE("where a condition holds a part of what would be merged, the rest is merged",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    for (bool const of_nodes : {true, false}) {
      TwoBodies<F, B> both(backend, 4);
      auto const nodes = both.body.nodes();
      std::vector<Index> all;
      for (Index e = 0; e < count(both.body); ++e) all.push_back(e);
      refine(both.body, {all});
      refine(both.host, {all});
      auto const hold = [&](auto& body) {
        if (of_nodes)
          body.hold(std::vector<Index>{nodes}, 1);  // one that the refinement made
        else
          body.hold({body.mesh().boundary("right")[0]}, 1);
      };
      hold(both.body);
      hold(both.host);
      all.clear();
      for (Index e = 0; e < count(both.body); ++e) all.push_back(e);
      auto const merged = coarsen(both.body, {all}).merged;
      CHECK(merged == coarsen(both.host, {all}).merged);
      CHECK(merged > 20);
      both.check_place();
      both.check_all();
      // What is refined beside it, too.
      std::vector<Index> all_but_one;
      for (Index e = 1; e < count(both.body); ++e) all_but_one.push_back(e);
      auto const again = refine(both.body, {all_but_one}).refined;
      CHECK(again == refine(both.host, {all_but_one}).refined);
      MarkedElements marked{.refine = {{0}}, .coarsen = {{}}};
      for (Index e = 1; e < count(both.body); ++e) marked.coarsen[0].push_back(e);
      auto const plan = plan_change(both.host.parts(), marked, 3);
      REQUIRE(plan);
      REQUIRE(plan->counts.refined > 0);
      commit(both.host.parts(), *plan);
      auto const done = detail::change_on_backend(
          both.body.parts(), {.refine = marked.refine, .coarsen = marked.coarsen}, 3);
      REQUIRE(done);
      CHECK(done->counts.refined == plan->counts.refined);
      CHECK(done->counts.coarsened == plan->counts.coarsened);
      CHECK(!done->to_tell.plan);
      CHECK(!done->to_tell.there);
      both.check_place();
      both.check_all();
    }
  });
}

TEST_CASE("the host falls behind by so many changes and no more", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const check = [&](Index cells, int rounds, auto const& check_most) {
      auto body = body_of<F>(backend, false, cells);
      auto const first = body.mesh();
      int most = 0;
      for (int round = 0; round < rounds; ++round) {
        refine(body, {{0}});
        std::vector<Index> all;
        for (Index e = 0; e < count(body); ++e) all.push_back(e);
        CHECK(coarsen(body, {all}).merged == 1);
        REQUIRE(is_on_backend(body));
        most = std::max(most, body.parts().topology_on->on_host.changes);
      }
      check_most(most, body.parts().topology_on->on_host.changes);
      CHECK(body.mesh().tables == first.tables);
    };
    check(3, 280, [](int most, int now) {
      CHECK(most == 512);
      CHECK(now == 2 * 280 - 512);
    });
    auto const few = count(body_of<F>(backend, false, 2));
    REQUIRE(64 * few < 512);
    check(2, 40 * few, [&](int most, int) { CHECK(most == 64 * few); });  // a cell in each change
  });
}

TEST_CASE("a mesh that is brought over to the host is the one that its changes make there",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_brought_over<Formulation<Tri3, Gauss<1>, NeoHookean>>(backend, 6, 5, 5);
    check_brought_over<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend, 6, 5, 5);
    check_brought_over<Formulation<Tet4, Gauss<1>, NeoHookean>>(backend, 3, 12, 5);
    check_brought_over<Formulation<Hex8, Gauss<2>, NeoHookean>>(backend, 3, 8, 4);
  });
}

#if !defined(__CUDACC__)
TEST_CASE("a mesh that another thread asks for is the same", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBodies<Formulation<Tri3, Gauss<1>, NeoHookean>, B> both(backend, 6);
    both.refine_one_in(5);
    both.refine_one_in(5);
    REQUIRE(is_on_backend(both.body));
    auto const topology = both.body.state().topology;
    std::thread([&] { (void)*topology; }).join();
    CHECK(topology->mesh().tables == both.host.mesh().tables);
    both.refine_one_in(5);
    both.check_all();
  });
}
#endif

TEST_CASE("a body goes on from a refinement on its backend by any other change", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    double const rounding = std::numeric_limits<double>::epsilon();
    auto body = body_of<F>(backend, false, 5), host = body_of<F>(backend, true, 5);
    auto const first = body.mesh();
    auto const masses = body.parts().layout.own_masses();
    Random random(4);
    auto const refine_both = [&] {
      auto const marked = some(host, 5, random);
      refine(body, {marked});
      refine(host, {marked});
    };
    refine_both();
    refine_both();
    REQUIRE(is_on_backend(body));
    auto const merged = some(host, 2, random);
    CHECK(coarsen(body, {merged}).merged == coarsen(host, {merged}).merged);
    CHECK(largest_difference(body.velocities(), host.velocities()) < 40 * rounding);
    CHECK(body.mesh().tables == host.mesh().tables);
    refine_both();
    check_same(body, host, rounding);

    std::ostringstream saved(std::ios::binary);
    body.save(saved);
    auto other = body_of<F>(backend, false, 5);
    std::istringstream stream(saved.str(), std::ios::binary);
    other.load(stream);
    CHECK(same_state(other.state(), body.state()));
    CHECK(other.parts().layout.own_masses() == body.parts().layout.own_masses());

    for (std::size_t merged_now = 1; merged_now > 0;) {
      std::vector<Index> all(at(count(body)));
      for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
      merged_now = coarsen(body, {all}).merged;
    }
    CHECK(body.mesh().nodes == first.nodes);
    CHECK(body.mesh().tables == first.tables);
    CHECK(body.parts().layout.own_masses() == masses);
  });
}

TEST_CASE("where a refinement on a backend fails, the body is as it was", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using F = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto body = body_of<F>(backend, false, 5), same = body_of<F>(backend, false, 5);
    CHECK_THROWS_WITH(coarsen(body, {{0, 25}}), says("coarsen: there is no Quad4 element 25"));
    Random random(2);
    auto const marked = some(body, 4, random);
    refine(body, {marked});
    refine(same, {marked});
    auto const check_unchanged = [&] {
      CHECK(same_state(body.state(), same.state()));
      CHECK(body.parts().layout.own_masses() == same.parts().layout.own_masses());
    };
    set_mesh_limits(body, {.nodes = at(body.nodes()) + 2});
    CHECK_THROWS_AS(refine(body, {{0, 1, 2, 3}}), Error);
    check_unchanged();
    set_mesh_limits(body, {});
    auto const none = "there is no Quad4 element " + std::to_string(count(body));
    CHECK_THROWS_WITH(refine(body, {{0, count(body)}}), says("refine: " + none));
    CHECK_THROWS_WITH(refine(body, {{-1}}), says("refine: there is no Quad4 element -1"));
    std::vector<Index> too_many(at(count(body)) + 1);
    std::iota(too_many.begin(), too_many.end(), 0);
    CHECK_THROWS_WITH(coarsen(body, {too_many}), says("coarsen: " + none));
    check_unchanged();
    CHECK_THROWS_WITH(refine(body, {{0}}, most_levels + 1), says("at most 63"));
    check_unchanged();
    // Set past the body's own checks.
    auto const before = download<double>(body.parts().state.v);
    auto broken = before;
    broken[0] = std::numeric_limits<double>::quiet_NaN();
    body.parts().state.v.upload(broken);
    CHECK_THROWS_AS(refine(body, {{0}}), Error);
    body.parts().state.v.upload(before);
    check_unchanged();

    std::vector<Index> all;
    for (Index e = 0; e < count(body); ++e) all.push_back(e);
    auto const check_coarsening = [&](auto& field, std::string const& name) {
      auto const kept = download<double>(field);
      auto not_finite = kept;
      not_finite[0] = std::numeric_limits<double>::quiet_NaN();
      field.upload(not_finite);
      CHECK_THROWS_WITH(coarsen(body, {all}), says(name));
      field.upload(kept);
      check_unchanged();
    };
    check_coarsening(body.parts().state.u, "displacements");
    check_coarsening(body.parts().state.v, "velocities");

    auto const next = some(body, 6, random);
    CHECK(refine(body, {next}).refined == refine(same, {next}).refined);
    REQUIRE(is_on_backend(body));
    CHECK(body.mesh().tables == same.mesh().tables);
    CHECK(body.parts().layout.own_masses() == same.parts().layout.own_masses());
    CHECK(body.displacements() == same.displacements());
    CHECK(largest_difference(body.velocities(), same.velocities()) < 1e-14);
    CHECK(refine(body, {{}}).refined == 0);
    CHECK(is_on_backend(body));
  });
}

}  // namespace pliant::test::refinement_on_backend_suite

#pragma once

#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/mesh/with_types.hpp>

#include "adaptation/changes_on_backend.hpp"
#include "topology/random_changes.hpp"

// Bodies whose elements are split into such of other shapes, and merged, in their backend's memory, beside bodies that the host changes.
namespace pliant::test::shapes_on_backend_suite {
using namespace two_bodies;
using Marks = std::vector<std::vector<Index>>;

struct Plane {
  static constexpr int dim = 2;
  static constexpr std::size_t whole = 1;
  using mesh_type = Mesh<Tri3, Quad4>;
  using Whole = Formulation<Quad4, Gauss<2>, NeoHookean>;
  using Part = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using WholeStiff = Formulation<Quad4, Gauss<2>, PerElement<Hooke>::law>;
  using PartStiff = Formulation<Tri3, Gauss<1>, PerElement<Hooke>::law>;
  static mesh_type mesh() { return mixed_mesh(7); }
  template <class B>
  static auto body(B const& backend, mesh_type const& mesh) {
    Group<WholeStiff> quads;
    Group<PartStiff> triangles;
    Random random(5);
    auto const fill = [&](auto& values, std::size_t count) {
      while (values.size() < count) values.push_back({1 + random(), 2 + random()});
    };
    fill(quads.values, std::get<1>(mesh.tables).size());
    fill(triangles.values, std::get<0>(mesh.tables).size());
    return Body(backend, mesh, soft, Group<Whole>{}, triangles, quads, Group<Part>{});
  }
};
struct Solid {
  static constexpr int dim = 3;
  static constexpr std::size_t whole = 0;
  using mesh_type = Mesh<Hex8, Pyramid5, Tet4>;
  using Whole = Formulation<Hex8, Gauss<2>, NeoHookean>;
  using Part = Formulation<Pyramid5, Gauss<2>, NeoHookean>;
  using WholeStiff = Formulation<Hex8, Gauss<2>, Hooke>;
  using PartStiff = Formulation<Pyramid5, Gauss<2>, Hooke>;
  using Tets = Formulation<Tet4, Gauss<1>, NeoHookean>;
  using TetsStiff = Formulation<Tet4, Gauss<1>, Hooke>;
  static mesh_type mesh() {
    return mesh::with_types<Hex8, Pyramid5, Tet4>(distorted_mesh<Hex8>(4));
  }
  template <class B>
  static auto body(B const& backend, mesh_type const& mesh) {
    return Body(backend, mesh, soft, Group<Whole>{}, Group<PartStiff>{}, Group<WholeStiff>{},
                Group<Part>{}, Group<TetsStiff>{}, Group<Tets>{});
  }
};

/// A body that moves, with conditions, a pressure and loads.
template <class P, class B>
auto set_up(B const& backend, bool on_host) {
  auto const mesh = P::mesh();
  auto body = P::body(backend, mesh);
  auto const u = set_in_motion(body, mesh);
  std::vector<Index> some;
  for (Index e = 0; e < static_cast<Index>(std::get<P::whole>(mesh.tables).size()); e += 2)
    some.push_back(e);
  body.template assign<typename P::WholeStiff>(some);
  body.set_loads(std::vector<Point<P::dim>>(mesh.nodes.size(), u[1]));
  if (on_host) change_on_host(body);
  return body;
}

template <class P, class B>
struct Beside {
  using Body = decltype(set_up<P>(std::declval<B const&>(), false));
  Body body, host;
  double rounding = std::numeric_limits<typename B::scalar>::epsilon();
  Random random{3};

  explicit Beside(B const& backend)
      : body(set_up<P>(backend, false)), host(set_up<P>(backend, true)) {}

  /// Some elements for which wanted(E{}).
  template <class Wanted>
  Marks some(std::size_t one_in, Wanted const& wanted) {
    auto marks = test::some(host, one_in, random, -1);
    detail::for_each_type_of<typename P::mesh_type>([&](auto element, std::size_t type) {
      if (!wanted(element)) marks[type].clear();
    });
    return marks;
  }
  void check_place() {
    REQUIRE(is_on_backend(body));
    REQUIRE(!is_on_backend(host));
  }
  void refine(Marks const& marked, int max_level = 3) {
    auto const done = pliant::refine(body, marked, max_level),
               wanted = pliant::refine(host, marked, max_level);
    CHECK(done.refined == wanted.refined);
    CHECK(done.new_nodes == wanted.new_nodes);
  }
  std::size_t coarsen(Marks const& marked) {
    auto const done = pliant::coarsen(body, marked), wanted = pliant::coarsen(host, marked);
    CHECK(done.merged == wanted.merged);
    CHECK(done.gone_nodes == wanted.gone_nodes);
    return done.merged;
  }
  std::size_t split(Marks const& marked, int triangles = 4) {
    auto const done = pliant::split(body, marked, {.triangles = triangles}),
               wanted = pliant::split(host, marked, {.triangles = triangles});
    CHECK(done.split == wanted.split);
    CHECK(done.new_nodes == wanted.new_nodes);
    return done.split;
  }
  std::size_t merge(Marks const& marked) {
    auto const done = pliant::merge(body, marked), wanted = pliant::merge(host, marked);
    CHECK(done.merged == wanted.merged);
    CHECK(done.gone_nodes == wanted.gone_nodes);
    return done.merged;
  }
  void check_all() { check_same(body, host, rounding); }
  /// Gives both the same state, so that rounding of steps does not add up.
  void go_on_alike() {
    auto const u = host.displacements(), v = host.velocities();
    for (auto* one : {&body, &host}) {
      one->set_displacements(u);
      one->set_velocities(v);
    }
  }
};

constexpr auto can_be_split = []<Element E>(E) { return !std::is_void_v<SplitInto<E>>; };
constexpr auto are_parts = []<Element E>(E) { return is_part<E>; };
constexpr auto any = [](auto) { return true; };

template <class P, class B>
void check_shapes(B const& backend, int rounds) {
  constexpr bool is_solid = P::dim == 3;
  Beside<P, B> both(backend);
  auto const first = both.body.mesh();
  auto const masses = both.body.parts().layout.own_masses();
  double const dt = 0.02 * stable_step(both.host);
  CentralDifference steps({.step = dt}), of_host({.step = dt});
  std::size_t split = 0, merged = 0;
  for (int round = 0; round < rounds; ++round) {
    if (round < 2) both.refine(both.some(is_solid ? 40 : 8, any));
    both.check_place();
    split += both.split(both.some(3, can_be_split), round % 2 == 0 ? 4 : 2);
    both.check_place();
    if (round != 1) both.check_all();
    if (!is_solid) split += both.split(both.some(4, can_be_split), 2);
    if (is_solid) split += both.split(both.some(8, can_be_split));
    both.check_place();
    both.check_all();
    auto loads = nodal_loads_of(both.host.parts());
    for (std::size_t i = 0; i < loads.size(); ++i) loads[i][0] += 0.1 * std::sin(double(i));
    for (auto* one : {&both.body, &both.host}) one->set_loads(loads);
    steps(both.body, 2);
    of_host(both.host, 2);
    CHECK(largest_difference(both.body.displacements(), both.host.displacements()) <
          1000 * both.rounding);
    both.go_on_alike();
    auto most = both.some(1, are_parts);
    for (auto& list : most) std::erase_if(list, [&](Index) { return both.random.below(12) == 0; });
    merged += both.merge(most);
    both.check_place();
    both.check_all();
    both.go_on_alike();
  }
  CHECK(split > 20);
  CHECK(merged > 8);
  for (std::size_t changed = 1; changed > 0;) {
    changed = both.merge(both.some(1, are_parts));
    both.check_place();
    changed += both.coarsen(test::all(both.host, -1));
  }
  both.check_all();
  CHECK(both.body.mesh().nodes == first.nodes);
  CHECK(both.body.mesh().tables == first.tables);
  CHECK(both.body.mesh().boundaries == first.boundaries);
  CHECK(both.body.parts().layout.own_masses() == masses);
}

TEST_CASE("elements are split and merged in a backend's memory as on the host", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_shapes<Plane>(backend, 4);
    check_shapes<Solid>(backend, 3);
  });
}

/// Marks for everything at once, as rules give them: what is refined, or split, is on no other list. `coarsens`: less is so.
template <class P, class B>
MarkedElements marks_of_all_sorts(Beside<P, B>& both, bool coarsens) {
  MarkedElements marked{.refine = both.some(P::dim == 3 || coarsens ? 80 : 24, any),
                        .coarsen = both.some(1, any),
                        .split = both.some(coarsens ? 60 : 12, can_be_split),
                        .split_in_two = both.some(coarsens ? 60 : 16, can_be_split),
                        .merge = both.some(1, are_parts)};
  std::vector const in_order{&marked.refine, &marked.split, &marked.split_in_two};
  for (std::size_t k = 0; k < in_order.size(); ++k) {
    auto others = std::vector{&marked.coarsen, &marked.merge};
    others.insert(others.end(), in_order.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                  in_order.end());
    for (auto* other : others)
      for (std::size_t type = 0; type < other->size(); ++type)
        std::erase_if((*other)[type],
                      [&](Index e) { return std::ranges::binary_search((*in_order[k])[type], e); });
  }
  return marked;
}
template <class TheBody>
auto change(TheBody& body, MarkedElements const& marked) {
  if (auto const done = detail::change_on_backend(body.parts(), marked, 3)) {
    tell_listeners(body.parts(), done->to_tell);
    return done->counts;
  }
  auto const plan = plan_change(body.parts(), marked, 3);
  if (!plan) return decltype(plan->counts){};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return plan->counts;
}

template <class P, class B>
void check_all_sorts(B const& backend, int rounds) {
  Beside<P, B> both(backend);
  typename TopologyPlan<typename P::mesh_type>::Counts sums;
  for (int round = 0; round < rounds; ++round) {
    auto const marked = marks_of_all_sorts(both, round % 3 == 2);
    auto const done = change(both.body, marked), wanted = change(both.host, marked);
    CHECK(done.refined == wanted.refined);
    CHECK(done.coarsened == wanted.coarsened);
    CHECK(done.split == wanted.split);
    CHECK(done.merged == wanted.merged);
    sums.coarsened += done.coarsened;
    sums.split += done.split;
    sums.merged += done.merged;
    both.check_place();
    CHECK(both.body.mesh().nodes == both.host.mesh().nodes);
    CHECK(both.body.mesh().tables == both.host.mesh().tables);
    CHECK(both.body.parts().layout.own_masses() == both.host.parts().layout.own_masses());
    CHECK(ledger(both.body).back().action == ledger(both.host).back().action);
  }
  CHECK(sums.coarsened > 3);
  CHECK(sums.split > 20);
  CHECK(sums.merged > 5);
}

TEST_CASE("elements are split and merged beside others that are refined and coarsened at once",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_all_sorts<Plane>(backend, 16);
    check_all_sorts<Solid>(backend, 12);
  });
}

template <class P>
inline constexpr std::size_t types_of = std::tuple_size_v<decltype(typename P::mesh_type{}.tables)>;

/// Merges what is split while finer elements beside it are refined.
template <class P, class B>
void check_divided_again(B const& backend) {
  Beside<P, B> both(backend);
  auto const levels = [&]<class E>(E) { return refinement_levels<E>(both.host); };
  using Whole = typename P::Whole::element;
  both.refine(both.some(5, can_be_split), 1);
  auto const coarse_and_fine = [&] {
    std::pair<Marks, Marks> lists;
    lists.first.resize(types_of<P>), lists.second.resize(types_of<P>);
    auto const all = levels(Whole{});
    for (std::size_t e = 0; e < all.size(); ++e)
      (all[e] == 0 ? lists.first : lists.second)[P::whole].push_back(static_cast<Index>(e));
    return lists;
  };
  auto const families = both.split(coarse_and_fine().first);
  MarkedElements marked{.refine = coarse_and_fine().second, .merge = both.some(1, are_parts)};
  for (auto& list : marked.refine) std::erase_if(list, [](Index e) { return e % 3 != 0; });
  auto const done = change(both.body, marked), wanted = change(both.host, marked);
  both.check_place();
  CHECK(done.merged == wanted.merged);
  CHECK(done.merged > 0);
  CHECK(done.merged < families);
  CHECK(done.refined == wanted.refined);
  CHECK(both.body.mesh().tables == both.host.mesh().tables);
}

TEST_CASE("what a refinement beside it would divide again stays split in a backend's memory",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_divided_again<Plane>(backend);
    check_divided_again<Solid>(backend);
  });
}

TEST_CASE("the host splits and merges where listeners are told, or a node has to stay",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    Beside<Plane, B> both(backend);
    both.split({{}, {0, 1, 2}});
    both.check_place();
    Index const centre = both.host.nodes() - 1;
    for (auto* one : {&both.body, &both.host}) one->hold(std::vector<Index>{centre}, 1);
    auto const parts = Marks{first_numbers(both.host.mesh().template elements<Tri3>().size()), {}};
    CHECK(both.merge(parts) == 2);  // but not around the held one
    CHECK(!is_on_backend(both.body));
    both.check_all();

    Beside<Plane, B> told(backend);
    int times = 0;
    for (auto* one : {&told.body, &told.host}) one->on_change([&](auto const&) { ++times; });
    told.split({{}, {0, 1}});
    told.merge(Marks{first_numbers(told.host.mesh().template elements<Tri3>().size()), {}});
    CHECK(times == 4);
    told.check_all();
  });
}

TEST_CASE("pyramids are refined and merged in a backend's memory as on the host", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    Beside<Solid, B> both(backend);
    auto const first = both.body.mesh();
    auto const masses = both.body.parts().layout.own_masses();
    both.split({{0, 1, 2, 3, 4, 5, 6, 7, 8}, {}, {}});
    both.refine({{}, {2, 7, 11, 20}, {}});
    both.check_all();
    std::size_t merged = 0;
    for (int round = 0; round < 2; ++round) {
      both.refine(both.some(25, any), 2);
      both.check_place();
      both.check_all();
      std::vector<Index> some;
      for (Index e = 0; e < static_cast<Index>(both.host.mesh().template elements<Tet4>().size());
           e += 3)
        some.push_back(e);
      for (auto* one : {&both.body, &both.host}) one->template assign<Solid::Tets>(some);
      auto loads = nodal_loads_of(both.host.parts());
      for (std::size_t i = 0; i < loads.size(); ++i) loads[i][1] += 0.1 * std::cos(double(i));
      for (auto* one : {&both.body, &both.host}) one->set_loads(loads);
      auto most = both.some(1, any);
      for (auto& list : most)
        std::erase_if(list, [&](Index) { return both.random.below(30) == 0; });
      merged += both.coarsen(most);
      both.check_place();
      both.check_all();
      both.go_on_alike();
    }
    CHECK(merged > 4);
    for (std::size_t changed = 1; changed > 0;)
      changed = both.coarsen(test::all(both.host, -1)) + both.merge(both.some(1, are_parts));
    both.check_place();
    both.check_all();
    CHECK(both.body.mesh().nodes == first.nodes);
    CHECK(both.body.mesh().tables == first.tables);
    CHECK(both.body.parts().layout.own_masses() == masses);
  });
}

TEST_CASE("a split that would exceed a limit in a backend's memory leaves the body as it was",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    Beside<Plane, B> both(backend);
    auto const nodes = at(both.host.nodes());
    set_mesh_limits(both.body, {.nodes = nodes + 1});
    CHECK_THROWS_WITH(split(both.body, {{}, {3, 4}}),
                      says("split 2 cells") && says("nodes in all"));
    CHECK(split(both.body, {{}, {3, 4}}, {.triangles = 2}).split == 2);
    CHECK(split(both.host, {{}, {3, 4}}, {.triangles = 2}).split == 2);
    both.check_place();
    both.check_all();
    CHECK_THROWS_WITH(split(both.body, {{0}, {}}), says("Tri3 elements cannot be split"));
    CHECK_THROWS_WITH(split(both.body, {{}, {-1}}), says("no Quad4 element -1"));
    CHECK_THROWS_WITH(merge(both.body, {{}, {0}}), says("no element is split into Quad4"));
    both.check_all();
  });
}

TEST_CASE("a block that loses as many elements as it gains is planned again", "[adaptation]") {
  auto const stays = [](std::vector<Index> staying) {
    return blocks_after_change({0, 4, 9}, {0, 4, 9}, staying).stays;
  };
  CHECK(stays({}) == std::vector<char>{1, 1});
  CHECK(stays({0, 4, 9}) == std::vector<char>{1, 1});
  CHECK(stays({0, 2, 7}) == std::vector<char>{0, 1});
  CHECK(blocks_after_change({0, 4, 9}, {0, 5, 10}, {0, 4, 9}).stays == std::vector<char>{0, 1});
}

TEST_CASE("rules split and merge in a backend's memory", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    Beside<Plane, B> both(backend);
    auto const rules = [] {
      return Adaptation{when<Plane::Whole>(StrainNorm{}).above(0.03).split({.triangles = 2}),
                        when<Plane::Part>(StrainNorm{}).below(0.02).merge()};
    };
    auto adapt = rules(), other = rules();
    auto const triangles = [](auto const& body) {
      return body.mesh().template elements<Tri3>().size();
    };
    std::vector<std::size_t> counts{triangles(both.host)};
    for (double const most : {0.1, 0.2, 0.0, 0.1}) {
      auto const& mesh = both.host.mesh();
      std::vector<Point<2>> u(mesh.nodes.size());
      for (std::size_t i = 0; i < u.size(); ++i)
        u[i] = {most * square(mesh.nodes[i][0]), most * mesh.nodes[i][1] * mesh.nodes[i][0]};
      for (auto* body : {&both.body, &both.host}) body->set_displacements(u);
      adapt.now(both.body);
      other.now(both.host);
      both.check_place();
      both.check_all();
      counts.push_back(triangles(both.host));
    }
    CHECK(counts[2] > counts[0]);
    CHECK(counts[3] < counts[2]);
    CHECK(counts[4] > counts[3]);
  });
}

/// Changes of every sort at random, in a backend's memory and on the host, and back to the first mesh.
template <class P, class B>
void check_storm(B const& backend, int changes) {
  double const rounding = std::numeric_limits<typename B::scalar>::epsilon();
  auto const made = [&](bool on_host) {
    auto body = P::body(backend);
    set_in_motion(body, body.mesh());
    if (on_host) change_on_host(body);
    return body;
  };
  auto body = made(false), host = made(true);
  auto const first = body.mesh();
  auto const masses = body.parts().layout.own_masses();
  Random random(11), again(11);
  for (int k = 0; k < changes; ++k) {
    change<P>(body, random);
    change<P>(host, again);
    if (k % 3 == 2) {
      check_same(body, host, rounding);
      auto const u = host.displacements(), v = host.velocities();
      for (auto* one : {&body, &host}) {
        one->set_displacements(u);
        one->set_velocities(v);
      }
    }
  }
  REQUIRE(is_on_backend(body));
  undo(body);
  REQUIRE(is_on_backend(body));
  CHECK(body.mesh().nodes == first.nodes);
  CHECK(body.mesh().tables == first.tables);
  CHECK(body.mesh().boundaries == first.boundaries);
  CHECK(body.parts().layout.own_masses() == masses);
}

TEST_CASE("a storm of changes of shape, degree and mesh in a backend's memory leads back",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_storm<ChangingPlane>(backend, 30);
    check_storm<ChangingSolid>(backend, 24);
  });
}

}  // namespace pliant::test::shapes_on_backend_suite

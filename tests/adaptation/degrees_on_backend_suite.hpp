#pragma once

#include <cstdlib>
#include <sstream>
#include <string>

#include "adaptation/both_types.hpp"

// Bodies of linear and quadratic elements whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::degrees_on_backend_suite {
using namespace two_bodies;

static_assert(detail::degrees_are_paired<Mesh<Quad4, Tri3, Quad9, Tri6>>);
static_assert(!detail::degrees_are_paired<Mesh<Quad4, Quad8, Quad9>>);

/// Raises one in two elements of the first type, and gives the other body the same.
template <Element A, Element C, class B>
void raise_some(BothTypes<A, C, B>& both) {
  auto marked = random_marks(both.host, both.random, 2);
  marked[1].clear();
  REQUIRE(raise(both.host, marked).raised > 4);
  std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
  both.host.save(saved);
  both.body.load(saved);  // which its backend may change
  REQUIRE(!both.host.mesh().slaves.empty());
}

template <Element A, Element C, class B>
void check_degrees(B const& backend, Mesh<A, C> const& mesh, std::size_t one_in) {
  BothTypes<A, C, B> both(backend, mesh);
  raise_some(both);
  both.check_all();
  std::size_t merged = 0;
  for (int round = 0; round < 3; ++round) {
    both.refine_one_in(one_in);
    both.check_all();
    both.refine_one_in(one_in);
    merged += both.coarsen_all_but_one_in(12);
    both.check_all();
  }
  CHECK(merged > 4);
}

TEST_CASE("elements of two degrees that a body's backend changes are those that the host makes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_degrees(backend, mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)), 6);
    check_degrees(backend, mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)), 6);
    check_degrees(backend, mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)), 8);
    if constexpr (on_all_backends)
      check_degrees(backend, mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex8>(3)), 8);
  });
}

/// Raises some elements of both bodies, or lowers some.
template <Element A, Element C, class B>
void convert_both(BothTypes<A, C, B>& both, bool raises, std::size_t one_in, int ring = 0) {
  auto marked = random_marks(both.host, both.random, one_in);
  marked[raises ? 1 : 0].clear();
  if (raises) {
    auto const done = raise(both.body, marked, {.ring = ring}),
               wanted = raise(both.host, marked, {.ring = ring});
    CHECK(wanted.raised > 0);
    CHECK(done.raised == wanted.raised);
    CHECK(done.new_nodes == wanted.new_nodes);
  } else {
    auto const done = lower(both.body, marked), wanted = lower(both.host, marked);
    CHECK(wanted.lowered > 0);
    CHECK(done.lowered == wanted.lowered);
    CHECK(done.gone_nodes == wanted.gone_nodes);
  }
  both.check_place();
}

template <Element A, Element C, class B>
void check_conversions(B const& backend, Mesh<A, C> const& mesh, std::size_t one_in) {
  BothTypes<A, C, B> both(backend, mesh);
  std::vector<double> of_nodes(mesh.nodes.size());
  for (std::size_t i = 0; i < of_nodes.size(); ++i) of_nodes[i] = std::sin(double(i));
  auto values = upload(backend, of_nodes), by_host = upload(backend, of_nodes);
  ColoursOfTypes<A, C, B> colours(both.body), colours_by_host(both.host);
  both.body.on_backend_change([&](auto const& change) { values = change.carry_nodes(values); });
  both.host.on_backend_change([&](auto const& change) { by_host = change.carry_nodes(by_host); });
  auto const check = [&] {
    CHECK(colours.all() == colours_by_host.all());
    CHECK(download<double>(values) == download<double>(by_host));
    both.check_all();
  };
  for (int round = 0; round < 2; ++round) {
    convert_both(both, true, 2);
    check();
    both.refine_one_in(one_in);
    convert_both(both, false, 3);
    check();
    convert_both(both, true, one_in, 1);
    both.coarsen_all_but_one_in(12);
    check();
  }
}

TEST_CASE("elements that a body's backend raises and lowers are those that the host makes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_conversions(backend, mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)), 6);
    check_conversions(backend, mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)), 6);
    check_conversions(backend, mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)), 8);
    if constexpr (on_all_backends)
      check_conversions(backend, mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex8>(3)), 8);
  });
}

/// A body of groups of both types with the same laws, one that keeps what points have seen and one of values per element.
template <Element A, Element C, class B>
auto body_of_laws(B const& backend, Mesh<A, C> const& mesh, bool on_host) {
  constexpr int dim = A::dim;
  auto const graded = []<class E>(E) {
    return Formulation<E, Gauss<points<E>>, PerElement<NeoHookean>::law>{};
  };
  using GradedA = decltype(graded(A{}));
  using GradedC = decltype(graded(C{}));
  auto const relaxing = []<class E>(E) {
    return Group<Viscous<E>>{typename Viscous<E>::template law<double>{{3, 2}, {0.5}, {0.1}}};
  };
  Random random(5);
  std::vector<std::array<double, 2>> values(mesh.template elements<A>().size());
  for (auto& v : values) v = {4 + random(), 2 + random()};
  Body body{backend,
            mesh,
            soft,
            Group<GradedA>{.values = values},
            relaxing(A{}),
            Group<Soft<C>>{},
            Group<GradedC>{},
            relaxing(C{})};
  std::vector<Index> some;
  for (Index e = 0; e < static_cast<Index>(values.size()); e += 2) some.push_back(e);
  body.template assign<Viscous<A>>(some);
  std::vector<Point<dim>> u(mesh.nodes.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < dim; ++k)
      u[i][k] = 0.05 * mesh.nodes[i][(k + 1) % dim] * mesh.nodes[i][k];
  body.set_displacements(u);
  if (on_host) change_on_host(body);
  return body;
}

TEST_CASE("what points keep and laws read goes along where a body's backend raises and lowers",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element A, Element C>(Mesh<A, C> const& mesh) {
      auto body = body_of_laws(backend, mesh, false), host = body_of_laws(backend, mesh, true);
      double const dt = 0.1 * stable_step(host);
      Random random(2);
      std::vector<double> kept;
      for (int round = 0; round < 2; ++round) {
        for (auto* one : {&body, &host}) CentralDifference({.step = dt})(*one, 3);
        std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
        host.save(saved);
        body.load(saved);  // to the bit
        auto marked = random_marks(host, random, 2);
        auto lowered = random_marks(host, random, 2);
        marked[1].clear();
        CHECK(raise(body, marked).raised == raise(host, marked).raised);
        if (round > 0) {
          lowered[0].clear();
          CHECK(lower(body, lowered).lowered == lower(host, lowered).lowered);
        }
        REQUIRE(is_on_backend(body));
        check_same(body, host, std::numeric_limits<typename B::scalar>::epsilon());
      }
      auto const& table = std::get<1>(host.parts().layout.tables);
      kept = table.in_user_order(std::get<1>(host.state().elements).internal_variables);
      CHECK(std::ranges::any_of(kept, [](double x) { return x != 0; }));
      CHECK(std::ranges::count(user_groups<C>(std::as_const(host.parts())), Tag{1}) > 2);
    };
    check(mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(5)));
    check(mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
  });
}

/// Marks of all sorts, of which each element has one at most; so many in 16 are to be merged.
template <class TheBody>
MarkedElements marks_of_all_sorts(TheBody const& body, std::size_t merged, Random& random) {
  MarkedElements marked{
      .refine = {{}, {}}, .coarsen = {{}, {}}, .raise = {{}, {}}, .lower = {{}, {}}};
  std::size_t type = 0;
  body.parts().for_each_type([&](auto const& table, auto const&) {
    auto& converted = type == 0 ? marked.raise : marked.lower;
    for (Index e = 0; e < table.count(); ++e) {
      auto const which = random.below(16);
      if (which == 0)
        marked.refine[type].push_back(e);
      else if (which <= merged)
        marked.coarsen[type].push_back(e);
      else if (which < 14)
        converted[type].push_back(e);
    }
    ++type;
  });
  return marked;
}

TEST_CASE("a body's backend makes changes of all sorts at once as the host does", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element A, Element C>(Mesh<A, C> const& mesh) {
      BothTypes<A, C, B> both(backend, mesh);
      int kept = 0;  // cells that would have been lowered, had they not been divided beside others
      std::size_t merged = 0;
      for (int round = 0; round < 12; ++round) {
        auto const marked = marks_of_all_sorts(both.host, round % 3 == 2 ? 12 : 3, both.random);
        auto const plan = plan_change(std::as_const(both.host.parts()), marked, 2);
        auto const done = detail::change_on_backend(both.body.parts(), marked, 2);
        REQUIRE(plan.has_value());
        REQUIRE(done.has_value());
        commit(both.host.parts(), *plan);
        auto const &counts = done->counts, &wanted = plan->counts;
        CHECK(counts.refined == wanted.refined);
        CHECK(counts.coarsened == wanted.coarsened);
        CHECK(counts.raised == wanted.raised);
        CHECK(counts.lowered == wanted.lowered);
        kept += counts.lowered < marked.lower[1].size();
        merged += counts.coarsened;
        both.check_place();
        CHECK(both.body.mesh().nodes == both.host.mesh().nodes);
        CHECK(both.body.mesh().tables == both.host.mesh().tables);
        CHECK(both.body.mesh().boundaries == both.host.mesh().boundaries);
        CHECK(both.body.parts().layout.own_masses() == both.host.parts().layout.own_masses());
        auto const entry = ledger(both.body).back(), other = ledger(both.host).back();
        CHECK(entry.action == other.action);
        CHECK(entry.elements == other.elements);
        both.go_on_alike();
      }
      CHECK(kept > 0);
      CHECK(merged > 0);
    };
    check(mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)));
    check(mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
  });
}

/// The place of an element's middle along x, where a body is at rest.
struct MiddleAlongX {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    constexpr int nodes = State::formulation::nodes;
    auto sum = e.rest(0, 0);
    for (int a = 1; a < nodes; ++a) sum = sum + e.rest(a, 0);
    return builtin_scalar<decltype(sum)>(1.0 / nodes) * sum;
  }
};

TEST_CASE("rules raise rings and lower in a backend's memory as by the host", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element A, Element C>(Mesh<A, C> const& mesh) {
      BothTypes<A, C, B> both(backend, mesh);
      std::size_t most = 0;
      for (double const edge : {-0.3, 0.0, 0.3}) {
        auto const count = [&](auto& body) { return body.template groups_of<C>().size(); };
        auto const adapt = [&](auto& body) {
          Adaptation{when<Soft<A>>(MiddleAlongX{}).above(edge).raise({.ring = 1}),
                     when<Soft<C>>(MiddleAlongX{}).below(edge - 0.2).lower(),
                     when<Soft<A>>(MiddleAlongX{}).below(-0.4).refine({.max_level = 1})}
              .now(body);
        };
        adapt(both.body);
        adapt(both.host);
        both.check_place();
        both.check_all();
        most = std::max(most, count(both.host));
      }
      CHECK(most > 5);
      CHECK(both.body.template groups_of<C>().size() != most);
    };
    check(mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(6)));
    check(mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
  });
}

TEST_CASE(
    "a mesh that holds an error by size and degree is changed in a backend's memory as by the host",
    "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element A, Element C>(Mesh<A, C> const& mesh) {
      BothTypes<A, C, B> both(backend, mesh);
      constexpr std::size_t dim = A::dim;
      auto const bump = [&](double place) {
        auto u = both.host.mesh().nodes;
        for (auto& p : u) {
          double apart = 0;
          for (std::size_t k = 0; k < dim; ++k) apart += square(p[k] - (k == 0 ? place : 0.4));
          p = {};
          p[1] = 0.05 * std::exp(-apart / square(0.3));
        }
        for (auto* one : {&both.body, &both.host}) one->set_displacements(u);
      };
      bump(0.2);
      double const error = estimate(both.host, RecoveredStress{});
      auto const rule =
          within<Soft<A>, Soft<C>>(RecoveredStress{}, {.error = error / 8, .max_level = 2});
      Adaptation held{rule}, other{rule};
      std::size_t raised = 0, refined = 0;
      for (double const place : {0.2, 0.2, 0.6, 0.9, 0.2}) {
        bump(place);
        held.now(both.body);
        other.now(both.host);
        both.check_place();
        REQUIRE(both.body.mesh().tables == both.host.mesh().tables);
        CHECK(both.body.mesh().nodes == both.host.mesh().nodes);
        raised = std::max(raised, both.host.template groups_of<C>().size());
        refined = std::max(refined, both.host.template groups_of<A>().size() +
                                        both.host.template groups_of<C>().size());
      }
      CHECK(raised > 0);
      CHECK(refined > mesh.template elements<A>().size());
    };
    check(mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(5)));
    check(mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
  });
}

TEST_CASE("what a backend does not give another degree by itself, the host does", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(4));
    {  // a listener gets what the host knows
      BothTypes<Quad4, Quad9, B> both(backend, mesh);
      Index told = 0;
      both.body.on_change([&](auto const& change) { told = change.transfer.nodes(); });
      raise(both.body, {{1, 2}, {}});
      raise(both.host, {{1, 2}, {}});
      both.check_all();
      CHECK(told == both.host.nodes());
      lower(both.body, {{}, {0}});
      lower(both.host, {{}, {0}});
      both.check_all();
      CHECK(told == both.host.nodes());
    }
    {  // a node that a condition names stays
      BothTypes<Quad4, Quad9, B> both(backend, mesh);
      for (auto* one : {&both.body, &both.host}) raise(*one, {{0, 1, 2, 3}, {}});
      both.check_place();
      both.check_all();
      Index const middle = both.host.nodes() - 1;
      for (auto* one : {&both.body, &both.host}) {
        one->hold(std::vector<Index>{middle}, 1);
        CHECK(lower(*one, {{}, {0, 1, 2, 3}}).lowered == 3);
      }
      both.check_all();
    }
    {  // what a law without its like keeps has to be brought to rest
      auto const made = [&](bool on_host) {
        Body body{backend, mesh, soft, Group<Soft<Quad4>>{},
                  Group<Viscous<Quad9>>{
                      typename Viscous<Quad9>::template law<double>{{3, 2}, {0.5}, {0.1}}}};
        std::vector<Point<2>> u(mesh.nodes.size());
        for (std::size_t k = 0; k < u.size(); ++k) u[k] = {0.1 * mesh.nodes[k][1], 0};
        body.set_displacements(u);
        if (on_host) change_on_host(body);
        raise(body, {{0, 3, 4}, {}});
        return body;
      };
      auto body = made(false), host = made(true);
      check_same(body, host, std::numeric_limits<typename B::scalar>::epsilon());
      auto const& table = std::get<1>(host.parts().layout.tables);
      auto const kept = table.in_user_order(std::get<1>(host.state().elements).internal_variables);
      CHECK(std::ranges::any_of(kept, [](double x) { return x != 0; }));
    }
  });
}

/// How many actions: PLIANT_CHANGES in the environment, or so many.
inline int actions(int usual) {
  auto const* const asked = std::getenv("PLIANT_CHANGES");
  return asked != nullptr ? std::atoi(asked) : usual;
}

template <Element A, Element C, class B>
void check_storm(B const& backend, Mesh<A, C> const& mesh) {
  BothTypes<A, C, B> both(backend, mesh);
  auto const first = both.body.mesh();
  auto const masses = both.body.parts().layout.own_masses();
  Random random(11);
  auto const some = [&](bool raises) {
    auto marked = random_marks(both.host, random, 2 + random.below(8));
    marked[raises ? 1 : 0].clear();
    return marked;
  };
  int there = 0;
  for (int k = 0; k < actions(40); ++k) {
    auto const action = random.below(8);
    INFO("action " << action);
    if (action < 2) {
      auto const marked = some(true);
      int const ring = static_cast<int>(random.below(2));
      CHECK(raise(both.body, marked, {.ring = ring}).raised ==
            raise(both.host, marked, {.ring = ring}).raised);
    } else if (action < 4) {
      auto const marked = some(false);
      CHECK(lower(both.body, marked).gone_nodes == lower(both.host, marked).gone_nodes);
    } else if (action == 4) {
      auto const marked = random_marks(both.host, random, 2 + random.below(8));
      CHECK(refine(both.body, marked, 2).new_nodes == refine(both.host, marked, 2).new_nodes);
    } else if (action == 5) {
      auto marked = random_marks(both.host, random, 1);
      for (auto& list : marked) std::erase_if(list, [&](Index) { return random.below(9) == 0; });
      CHECK(coarsen(both.body, marked).merged == coarsen(both.host, marked).merged);
    } else if (action == 6) {
      std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
      both.body.save(saved);
      std::stringstream again(saved.str(), std::ios::in | std::ios::binary);
      both.body.load(saved);
      both.host.load(again);
      change_on_host(both.host);
    } else {
      auto const marked = some(true);
      auto const nodes = static_cast<std::size_t>(both.host.nodes()) + 1;
      auto const words = [&](auto& body) -> std::string {
        set_mesh_limits(body, {.nodes = nodes});
        try {
          return std::to_string(raise(body, marked).raised);
        } catch (Error const& error) {
          return error.what();
        }
      };
      CHECK(words(both.body) == words(both.host));
      for (auto* one : {&both.body, &both.host}) set_mesh_limits(*one, {});
    }
    there += is_on_backend(both.body);
    if (k % 4 == 3) {
      both.check_all();
      both.go_on_alike();
    }
  }
  CHECK(there > actions(40) / 2);
  auto quadratic = all_elements(both.body);
  quadratic[0].clear();
  lower(both.body, quadratic);
  while (coarsen(both.body, all_elements(both.body)).merged > 0) {
  }
  REQUIRE(is_on_backend(both.body));
  CHECK(both.body.mesh().nodes == first.nodes);
  CHECK(both.body.mesh().tables == first.tables);
  CHECK(both.body.mesh().boundaries == first.boundaries);
  CHECK(both.body.parts().layout.own_masses() == masses);
}

TEST_CASE("a storm of changes of degree and mesh in a backend's memory leads back",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_storm(backend, mesh::with_types<Tri3, Tri6>(distorted_mesh<Tri3>(4)));
    check_storm(backend, mesh::with_types<Quad4, Quad9>(distorted_mesh<Quad4>(4)));
    check_storm(backend, mesh::with_types<Tet4, Tet10>(distorted_mesh<Tet4>(2)));
    if constexpr (on_all_backends)
      check_storm(backend, mesh::with_types<Hex8, Hex27>(distorted_mesh<Hex8>(2)));
  });
}

}  // namespace pliant::test::degrees_on_backend_suite

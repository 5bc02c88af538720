#pragma once

#include <cmath>

#include <pliant/law/decorators/viscosity.hpp>

#include "adaptation/changes_on_backend.hpp"
#include "adaptation/plane_bodies.hpp"

// Bodies of two element types whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::two_bodies {

template <class E>
inline constexpr int points = (SimplexCell<typename E::cell> ? 0 : 1) + E::degree;
template <class E>
using Soft = Formulation<E, Gauss<points<E>>, NeoHookean>;
template <class E>
using Viscous = Formulation<E, Gauss<points<E>>, Prony<NeoHookean>::law>;

/// A body of two types, of which one has a viscous group too. `on_host`: it is changed by the host.
template <Element A, Element C, class B>
auto body_of_both(B const& backend, Mesh<A, C> const& mesh, bool on_host) {
  Group<Viscous<C>> viscous{typename Viscous<C>::template law<double>{{3, 2}, {0.5}, {0.1}}};
  Body body{backend, mesh, soft, Group<Soft<A>>{}, Group<Soft<C>>{}, viscous};
  auto const u = set_in_motion(body, mesh);
  std::vector<Index> some;
  for (Index e = 0; e < static_cast<Index>(mesh.template elements<C>().size()); e += 2)
    some.push_back(e);
  body.template assign<Viscous<C>>(some);
  body.set_loads(std::vector<Point<A::dim>>(mesh.nodes.size(), u[1]));
  if (on_host) change_on_host(body);
  return body;
}

/// A body whose mesh is changed in its backend's memory, and one that the host changes.
template <Element A, Element C, class B>
struct BothTypes {
  using Body = decltype(body_of_both(std::declval<B const&>(), Mesh<A, C>{}, false));
  Body body, host;
  double rounding = std::numeric_limits<typename B::scalar>::epsilon();
  Random random{3};

  BothTypes(B const& backend, Mesh<A, C> const& mesh)
      : body(body_of_both(backend, mesh, false)), host(body_of_both(backend, mesh, true)) {}

  void refine_one_in(std::size_t one_in) {
    auto const marked = random_marks(host, random, one_in);
    auto const done = refine(body, marked, 3), wanted = refine(host, marked, 3);
    CHECK(done.refined == wanted.refined);
    CHECK(done.new_nodes == wanted.new_nodes);
    check_place();
  }
  std::size_t coarsen_all_but_one_in(std::size_t one_in) {
    auto const left = random_marks(host, random, one_in);
    Marks marked;
    host.parts().for_each_type([&](auto const& table, auto const&) {
      auto const& own = left[marked.size()];
      auto& list = marked.emplace_back();
      for (Index e = 0; e < table.count(); ++e)
        if (!std::ranges::binary_search(own, e)) list.push_back(e);
    });
    auto const done = coarsen(body, marked), wanted = coarsen(host, marked);
    CHECK(done.merged == wanted.merged);
    CHECK(done.gone_nodes == wanted.gone_nodes);
    check_place();
    return done.merged;
  }
  /// Gives both the same state, so that rounding of steps does not add up.
  void go_on_alike() {
    auto const u = host.displacements(), v = host.velocities();
    for (auto* one : {&body, &host}) {
      one->set_displacements(u);
      one->set_velocities(v);
    }
    std::vector<std::vector<double>> kept;
    host.parts().for_each_type([&](auto const& table, auto const& elements) {
      kept.push_back(table.in_user_order(elements.internal_variables));
    });
    std::size_t type = 0;
    body.parts().for_each_type([&](auto const& table, auto& elements) {
      elements.internal_variables.upload(table.in_internal_order(kept[type++]));
    });
  }
  void check_all() { check_same(body, host, rounding); }
  void check_place() {
    REQUIRE(is_on_backend(body));
    REQUIRE(!is_on_backend(host));
  }
};

/// All elements of a body, by the type.
template <class TheBody>
Marks all_elements(TheBody const& body) {
  Marks marks;
  body.parts().for_each_type([&](auto const& table, auto const&) {
    auto& list = marks.emplace_back();
    for (Index e = 0; e < table.count(); ++e) list.push_back(e);
  });
  return marks;
}

/// A number of each element of a body, by the type, in its backend's memory.
template <Element A, Element C, class B>
class ColoursOfTypes {
 public:
  template <class TheBody>
  explicit ColoursOfTypes(TheBody& body) {
    body.parts().for_each_type([&](auto const& table, auto const&) {
      std::vector<int> colours(at(table.count()));
      for (std::size_t e = 0; e < colours.size(); ++e) colours[e] = static_cast<int>(e * e % 7);
      colours_.push_back(upload(body.parts().backend, colours));
    });
    body.on_backend_change([this](BackendChange<Mesh<A, C>, B> const& change) {
      auto first = change.carry_elements(colours_, 0);
      colours_[1] = change.carry_elements(colours_, 1);
      colours_[0] = std::move(first);
    });
  }
  [[nodiscard]] std::vector<std::vector<int>> all() const {
    return {download<int>(colours_[0]), download<int>(colours_[1])};
  }

 private:
  std::vector<typename B::template Array<int>> colours_;
};

template <Element A, Element C, class B>
void check_both_types(B const& backend, Mesh<A, C> const& mesh, std::size_t one_in) {
  BothTypes<A, C, B> both(backend, mesh);
  auto const first = both.body.mesh();
  auto const masses = both.body.parts().layout.own_masses();
  double const dt = 0.05 * stable_step(both.host);
  CentralDifference steps({.step = dt}), of_host({.step = dt});
  std::size_t merged = 0;
  std::vector<double> of_nodes(first.nodes.size());
  for (std::size_t i = 0; i < of_nodes.size(); ++i) of_nodes[i] = std::sin(double(i));
  auto values = upload(backend, of_nodes), by_host = upload(backend, of_nodes);
  ColoursOfTypes<A, C, B> colours(both.body), colours_by_host(both.host);
  both.body.on_backend_change([&](auto const& change) { values = change.carry_nodes(values); });
  both.host.on_backend_change([&](auto const& change) { by_host = change.carry_nodes(by_host); });
  for (int round = 0; round < 2; ++round) {
    both.refine_one_in(one_in);
    both.check_all();
    both.refine_one_in(one_in);
    merged += both.coarsen_all_but_one_in(12);
    CHECK(colours.all() == colours_by_host.all());
    if (round == 1) both.check_all();
    steps(both.body, 2);
    of_host(both.host, 2);
    CHECK(largest_difference(both.body.displacements(), both.host.displacements()) <
          1000 * both.rounding);
    both.go_on_alike();
  }
  CHECK(merged > 4);
  CHECK(values.size() == at(both.body.nodes()));
  CHECK(download<double>(values) == download<double>(by_host));
  while (coarsen(both.body, all_elements(both.body)).merged > 0) {
  }
  CHECK(both.body.mesh().nodes == first.nodes);
  CHECK(both.body.mesh().tables == first.tables);
  CHECK(both.body.mesh().boundaries == first.boundaries);
  CHECK(both.body.parts().layout.own_masses() == masses);
}

}  // namespace pliant::test::two_bodies

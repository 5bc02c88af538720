#pragma once

#include <stdexcept>

#include "adaptation/two_bodies.hpp"
#include "support/spring.hpp"

// What listeners are told of bodies whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::listeners_on_backend_suite {
using namespace two_bodies;

using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
using M = Mesh<Tri3>;

/// What a simulator keeps of a body's nodes and elements, and is told.
struct Told {
  std::vector<double> of_nodes, of_elements;
  int calls = 0;

  template <class TheBody>
  explicit Told(TheBody const& body) : of_nodes(at(body.nodes())), of_elements(at(count(body))) {
    for (std::size_t i = 0; i < of_nodes.size(); ++i) of_nodes[i] = std::sin(1.0 + double(i));
    for (std::size_t e = 0; e < of_elements.size(); ++e) of_elements[e] = double(e);
  }
  template <class TheBody>
  void listen_to(TheBody& body) {
    body.on_change([this, &body](TopologyChange<M> const& change) {
      ++calls;
      CHECK(change.after.mesh().tables == body.mesh().tables);
      CHECK(change.before.nodes() == static_cast<Index>(of_nodes.size()));
      of_nodes = change.transfer.carry_nodes(std::move(of_nodes));
      of_elements = change.transfer.carry_elements(of_elements);
    });
  }
};

/// Two bodies with listeners.
template <class B>
struct TwoWithListeners : TwoBodies<F, B> {
  Told told{this->body}, wanted{this->host};

  explicit TwoWithListeners(B const& backend) : TwoBodies<F, B>(backend, 6) {}
  void listen() {
    told.listen_to(this->body);
    wanted.listen_to(this->host);
  }
  void check_told(int calls) {
    CHECK(told.calls == calls);
    CHECK(wanted.calls == calls);
    CHECK(told.of_nodes == wanted.of_nodes);
    CHECK(told.of_elements == wanted.of_elements);
    CHECK(this->body.parts().topology_on->on_host.changes == 0);  // the host does not fall behind
    this->check_place();
    this->check_all();
  }
};

TEST_CASE("listeners are told of what is changed in a backend's memory as of what the host changes",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoWithListeners<B> both(backend);
    both.listen();
    both.body.on_change([&](TopologyChange<M> const& change) {
      CHECK(&change.after.mesh() == &both.body.mesh());  // one for both
    });
    int calls = 0;
    for (int round = 0; round < 3; ++round) {
      both.refine_one_in(5);
      both.check_told(++calls);
      if (both.coarsen_all_but_one_in(8) > 0) ++calls;
      both.check_told(calls);
    }
    CHECK(calls == 6);
    refine(both.body, {{}});
    coarsen(both.body, {{0}});  // one of a family
    CHECK(both.told.calls == calls);
  });
}

TEST_CASE("who listens later is told of what comes then", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoWithListeners<B> both(backend);
    both.refine_one_in(5);
    both.refine_one_in(7);  // the host knows of neither
    both.told = Told(both.body);
    both.wanted = Told(both.host);
    both.listen();
    both.refine_one_in(6);
    both.check_told(1);
    CHECK(both.coarsen_all_but_one_in(8) > 0);
    both.check_told(2);
  });
}

TEST_CASE("listeners are told at once of what rules refine and coarsen", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoWithListeners<B> both(backend);
    both.listen();
    int calls = 0;
    both.refine_one_in(3);
    both.check_told(++calls);
    for (int round = 0; round < 3; ++round) {
      auto const marked = both.refine_one_in_and_coarsen(12);
      auto const plan = plan_change(both.host.parts(), marked, 3);
      REQUIRE(plan);
      REQUIRE(plan->counts.refined > 0);
      REQUIRE(plan->counts.coarsened > 0);
      commit(both.host.parts(), *plan);
      tell_listeners(both.host.parts(), *plan);
      auto const done = detail::change_on_backend(
          both.body.parts(), {.refine = marked.refine, .coarsen = marked.coarsen}, 3);
      REQUIRE(done);
      REQUIRE(done->to_tell.plan);
      tell_listeners(both.body.parts(), done->to_tell);
      both.check_told(++calls);
    }
  });
}

/// Two values of each node and of each element of a body, and a colour of each element, in its backend's memory, and how often they
/// were carried over.
template <class TheBody>
class CarriedThere {
  using B = typename TheBody::backend_type;
  using Change = BackendChange<typename TheBody::mesh_type, B>;

 public:
  explicit CarriedThere(TheBody& body, int* calls_before = nullptr)
      : values_(upload(body.parts().backend, first(at(body.nodes())))),
        of_elements_(upload(body.parts().backend, first(at(count(body))))),
        colours_(upload(body.parts().backend, colours_of(at(count(body))))) {
    body.on_backend_change([this, &body, calls_before](Change const& change) {
      ++calls;
      if (calls_before != nullptr) CHECK(*calls_before >= calls);  // others are told first
      CHECK(change.nodes() == body.nodes());
      CHECK_THROWS_WITH(change.carry_nodes(values_, 3), says("give the array from before it"));
      CHECK_THROWS_WITH(change.carry_nodes(values_.data(), values_.data(), 0),
                        says("0 components"));
      values_ = change.carry_nodes(values_, 2);
      CHECK(change.elements() == count(body));
      CHECK(at(change.elements_before()) == colours_.size());
      CHECK_THROWS_WITH(change.carry_elements(of_elements_, 0, 3),
                        says("give the array from before it"));
      CHECK_THROWS_WITH(change.carry_elements(of_elements_, 0, 0), says("a width of 0"));
      of_elements_ = change.carry_elements(of_elements_, 0, 2);
      colours_ = change.carry_elements(colours_);
    });
  }
  /// Gives elements other values, so that those of a family differ.
  void renew(TheBody const& body) {
    of_elements_ = upload(body.parts().backend, first(at(count(body))));
    colours_ = upload(body.parts().backend, colours_of(at(count(body))));
  }
  [[nodiscard]] std::vector<double> values() const { return download<double>(values_); }
  [[nodiscard]] std::vector<double> of_elements() const { return download<double>(of_elements_); }
  [[nodiscard]] std::vector<int> colours() const { return download<int>(colours_); }
  int calls = 0;

 private:
  static std::vector<double> first(std::size_t nodes) {
    std::vector<double> values(2 * nodes);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = i % 2 == 0 ? std::sin(double(i)) : 0.1;
    return values;
  }
  static std::vector<int> colours_of(std::size_t elements) {
    std::vector<int> colours(elements);
    for (std::size_t e = 0; e < elements; ++e) colours[e] = static_cast<int>(e * e % 5);
    return colours;
  }
  typename B::template Array<double> values_, of_elements_;
  typename B::template Array<int> colours_;
};

/// Of numbers of the size of one: by no more than rounding, which devices do in another order.
void check_close(std::vector<double> const& values, std::vector<double> const& wanted) {
  REQUIRE(values.size() == wanted.size());
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    largest = std::max(largest, std::abs(values[i] - wanted[i]));
  CHECK(largest < 1e-15 * 8);
}

template <class G, class B>
void check_carried_there(B const& backend, Index cells, std::size_t one_in) {
  TwoBodies<G, B> both(backend, cells);
  CarriedThere there(both.body), by_host(both.host);
  auto const check = [&](int calls) {
    CHECK(there.calls == calls);
    CHECK(by_host.calls == calls);
    auto const values = there.values();
    CHECK(values == by_host.values());
    CHECK(values.size() == 2 * at(both.body.nodes()));
    for (std::size_t i = 1; i < values.size(); i += 2) REQUIRE(values[i] == 0.1);
    CHECK(there.of_elements().size() == 2 * at(count(both.body)));
    check_close(there.of_elements(), by_host.of_elements());
    CHECK(there.colours() == by_host.colours());
  };
  int calls = 0;
  for (int round = 0; round < 2; ++round) {
    both.refine_one_in(one_in);
    check(++calls);
    both.refine_one_in(one_in);
    check(++calls);
    there.renew(both.body);
    by_host.renew(both.host);
    CHECK(both.coarsen_all_but_one_in(12) > 0);
    check(++calls);
    there.renew(both.body);
    by_host.renew(both.host);
    auto const marked = both.refine_one_in_and_coarsen(9);
    auto const plan = plan_change(both.host.parts(), marked, 3);
    REQUIRE(plan);
    commit(both.host.parts(), *plan);
    tell_listeners(both.host.parts(), *plan);
    auto const done = detail::change_on_backend(
        both.body.parts(), {.refine = marked.refine, .coarsen = marked.coarsen}, 3);
    REQUIRE(done);
    REQUIRE(done->counts.coarsened > 0);
    REQUIRE(done->counts.refined > 0);
    tell_listeners(both.body.parts(), done->to_tell);
    check(++calls);
  }
  CHECK(both.body.parts().topology_on->on_host.changes > 0);  // the host planned none of them
}

TEST_CASE("values of nodes and elements in a backend's memory follow the mesh there as on the host",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_carried_there<F>(backend, 6, 5);
    check_carried_there<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend, 4, 5);
    check_carried_there<Formulation<Tet10, Gauss<2>, NeoHookean>>(backend, 2, 3);
  });
}

/// The strain along x of an element.
struct Longer {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.gradient()(0, 0);
  }
};

/// Springs, which are made so many times.
template <class B>
auto springs(int& left) {
  return [&left](B const& b, NodeRows const& rows) -> std::unique_ptr<AnyForceTerm<B, 2>> {
    if (left-- == 0) throw std::runtime_error("no springs");
    return std::make_unique<ConnectedTerm<B, Spring>>(
        b, std::vector<std::array<Index, 2>>{{rows.of_node[0], rows.of_node[1]}}, Spring<double>{2},
        rows.count());
  };
}

TEST_CASE(
    "what is merged beside elements of which the refinement fails is told, and stays switched",
    "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    using Other = Stiffer<F>;
    auto body = body_of<F>(backend, false, 6, false), twin = body_of<F>(backend, false, 6, false);
    int left = 3, enough = 100;
    body.add(springs<B>(left));
    twin.add(springs<B>(enough));
    for (auto* one : {&body, &twin}) {
      std::vector<Index> all(at(count(*one)));
      for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
      refine(*one, {all});
      auto u = one->mesh().nodes;
      for (auto& x : u) x = {0.25 * square(x[0]), 0};
      one->set_displacements(u);
    }
    Told told(body);
    told.listen_to(body);
    CarriedThere there(body, &told.calls);
    Adaptation adapt{when<F>(Longer{}).above(0.2).template become<Other>(),
                     when<Other>(Longer{}).above(0.3).refine({.max_level = 2}),
                     when<F>(Longer{}).below(0.15).coarsen(),
                     when<Other>(Longer{}).below(0.15).coarsen()};
    auto const before = count(body);
    auto const entries = ledger(body).size();

    CHECK_THROWS_WITH(adapt.now(body), says("no springs"));

    REQUIRE(count(body) < before);
    CHECK(told.calls == 1);
    CHECK(told.of_nodes.size() == at(body.nodes()));
    CHECK(there.calls == 1);
    CHECK(there.values().size() == 2 * at(body.nodes()));
    CHECK(told.of_elements.size() == at(count(body)));
    CHECK(ledger(body).size() == entries + 2);
    auto const is_merging = [](auto const& entry) { return entry.action == "coarsen"; };
    CHECK(std::ranges::count_if(ledger(body), is_merging) == 1);
    auto const groups = body.template groups_of<Tri3>();
    auto const longer = evaluate<Tri3>(body, Longer{});
    REQUIRE(groups.size() == longer.size());
    int switched = 0;
    for (std::size_t e = 0; e < groups.size(); ++e)
      if (longer[e] > 0.2) {
        ++switched;
        CHECK(groups[e] == 1);
      }
    CHECK(switched > 20);
    left = 100;
    adapt.now(body);  // refines
    adapt.now(twin);
    CHECK(told.calls == 2);
    CHECK(there.calls == 2);
    CHECK(there.values().size() == 2 * at(body.nodes()));
    REQUIRE(count(body) > before);
    CHECK(body.mesh().nodes == twin.mesh().nodes);
    CHECK(body.mesh().tables == twin.mesh().tables);
    CHECK(body.template groups_of<Tri3>() == twin.template groups_of<Tri3>());
    CHECK(largest_difference(body.displacements(), twin.displacements()) < 1e-14);
    CHECK(largest_difference(body.forces(), twin.forces()) < 1e-12);
    REQUIRE(is_on_backend(body));
  });
}

}  // namespace pliant::test::listeners_on_backend_suite

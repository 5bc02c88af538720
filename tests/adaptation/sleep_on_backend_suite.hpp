#pragma once

#include "adaptation/two_bodies.hpp"

// Bodies that sleep in part and whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::sleep_on_backend_suite {
using namespace two_bodies;

using F = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;

/// A long bar, of as many elements as make several patches.
template <Backend B>
auto bar_on(B const& backend, bool on_host) {
  int const rows = B::orders_by_group ? 6 : 3;  // patches of OpenMP are larger
  auto const mesh = mesh::rectangle<Tri3>({.size = {20, 0.05 * rows}, .cells = {400, rows}});
  Body body{backend, mesh, soft, Group<F>{}};
  if (on_host) change_on_host(body);
  return body;
}

/// Two bars that take the same steps and looks. set_up(bar).
template <Backend B>
struct TwoBars {
  using Bar = decltype(bar_on(std::declval<B const&>(), false));
  Bar body, host;
  CentralDifference step, other_step;
  Adaptation<decltype(sleep({}))> adapt{sleep({.below = 1e-4, .for_steps = 16})},
      other_adapt{adapt};

  template <class SetUp>
  TwoBars(B const& backend, SetUp const& set_up)
      : body(bar_on(backend, false)), host(bar_on(backend, true)) {
    set_up(body);
    set_up(host);
  }
  /// Long enough for patches to fall asleep. Returns how many did.
  Index go_on() {
    for (int k = 0; k < 40; ++k) {
      step(body);
      adapt(body);
      other_step(host);
      other_adapt(host);
    }
    auto const found = asleep(body), wanted = asleep(host);
    CHECK(found.of_patches == wanted.of_patches);
    CHECK(found.patches == wanted.patches);
    CHECK(largest_difference(body.displacements(), host.displacements()) < 1e-12);
    return found.patches;
  }
  /// Until some sleep, and others do not.
  void settle() {
    CHECK(go_on() > 0);
    CHECK(asleep(body).patches < asleep(body).of_patches);
  }
  std::vector<Index> right_of(double x) const {
    std::vector<Index> list;
    auto const& elements = host.mesh().template elements<Tri3>();
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (host.mesh().nodes[at(elements[e][0])][0] > x) list.push_back(static_cast<Index>(e));
    return list;
  }
  /// Both ways.
  void change(std::vector<Index> const& marked) {
    CHECK(refine(body, {marked}).refined == refine(host, {marked}).refined);
    check_awake();
    settle();
    auto const right = right_of(17);
    auto const merged = coarsen(body, {right}).merged;
    CHECK(merged > 0);
    CHECK(merged == coarsen(host, {right}).merged);
    check_awake();
    settle();
  }
  /// A change wakes all.
  void check_awake() {
    REQUIRE(is_on_backend(body));
    REQUIRE(!is_on_backend(host));
    CHECK(asleep(body).patches == 0);
    CHECK(body.nodes() == host.nodes());
  }
};

TEST_CASE("what slept sleeps again where a body's backend changes its mesh", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBars<B> both(backend, [](auto& body) {
      auto v = body.velocities();
      for (std::size_t i = 0; i < v.size(); ++i)
        if (body.mesh().nodes[i][0] < 0.3) v[i] = {0.05, 0.02};
      body.set_velocities(v);
    });
    both.settle();
    both.change(both.right_of(15));
  });
}

TEST_CASE("what is driven stays awake where a body's backend changes its mesh", "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    TwoBars<B> both(backend, [](auto& body) {
      body.drive(body.mesh().boundary("left"), [](double) { return Point<2>{}; });
    });
    both.settle();  // the driven end does not, though nothing moves
    both.change(both.right_of(15));
    auto const before = asleep(both.body).patches;
    both.body.drive(both.body.mesh().boundary("right"), [](double) { return Point<2>{}; });
    both.host.drive(both.host.mesh().boundary("right"), [](double) { return Point<2>{}; });
    CHECK(both.go_on() < before);
  });
}

}  // namespace pliant::test::sleep_on_backend_suite

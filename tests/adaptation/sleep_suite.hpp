#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>

#include "support/formulations.hpp"
#include "support/small_patches.hpp"

namespace pliant::test::sleep_suite {

using Tri = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
using Soft = Formulation<Tri3, Gauss<1>, Hooke>;

constexpr double slow = 1e-4;  // m/s

/// A long bar, of as many elements as make several patches; a hit at its left end has not gone far after some steps.
template <Backend B>
auto bar_on(B const& backend) {
  int const rows = B::orders_by_group ? 6 : 3;  // patches of OpenMP are larger
  auto const mesh = mesh::rectangle<Tri3>({.size = {20, 0.05 * rows}, .cells = {400, rows}});
  Body body{backend, mesh, soft, Group<Tri>{}, Group<Soft>{}};
  return body;
}
template <class TheBody>
void hit_left_end(TheBody& body) {
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i)
    if (body.mesh().nodes[i][0] < 0.3) v[i] = {0.05, 0.02};
  body.set_velocities(v);
}
/// Stretched between its ends, at rest.
template <class TheBody>
void stretch(TheBody& body) {
  auto u = body.mesh().nodes;
  for (auto& p : u) p = {0.05 * p[0], 0};
  body.set_displacements(u);
  for (char const* end : {"left", "right"}) body.clamp(body.mesh().boundary(end));
  for (char const* edge : {"bottom", "top"}) body.hold(body.mesh().boundary(edge), 2);
}
inline auto quick_sleep() { return sleep({.below = slow, .for_steps = 16}); }

/// Steps until something sleeps.
template <class TheBody, class Step, class Adapt>
void settle(TheBody& body, Step& step, Adapt& adapt) {
  for (int k = 0; k < 40; ++k) {
    step(body);
    adapt(body);
  }
  REQUIRE(asleep(body).patches > 0);
  REQUIRE(asleep(body).patches < asleep(body).of_patches);
}
template <class TheBody>
double furthest_apart(TheBody const& a, TheBody const& b) {
  auto const u = a.displacements(), w = b.displacements();
  double apart = 0;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < u[i].size(); ++k)
      apart = std::max(apart, std::abs(u[i][k] - w[i][k]));
  return apart;
}
/// A constant force on each of some nodes.
template <class T>
struct Pull {
  static constexpr int dim = 2, nodes = 1;
  template <class U>
  using rebind = Pull<U>;
  T strength;
  template <class V>
  PLIANT_HOST_DEVICE auto force(V const&, V const& u) const {
    auto f = u;
    f(0, 0) = strength;
    f(0, 1) = T(0);
    return f;
  }
};
/// The same, from when its owner says.
template <Backend B>
class LatePull : public ConnectedTerm<B, Pull> {
 public:
  LatePull(B const& backend, Index node, Index nodes, std::shared_ptr<bool const> pulls)
      : ConnectedTerm<B, Pull>(backend, {{node}}, Pull<double>{0.3}, nodes),
        pulls_(std::move(pulls)) {}
  void add_force(B const& backend, typename LatePull::At const& at,
                 typename LatePull::Field f) const override {
    if (*pulls_) ConnectedTerm<B, Pull>::add_force(backend, at, f);
  }

 private:
  std::shared_ptr<bool const> pulls_;
};

TEST_CASE("what sleeps does not differ from what is awake by more than its threshold allows",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto plain = bar_on(backend), body = bar_on(backend);
    hit_left_end(plain);
    hit_left_end(body);
    CentralDifference step, same_step;
    Adaptation adapt{quick_sleep()};
    Index fewest = 1000, most = 0;
    for (int k = 0; k < 500; ++k) {
      same_step(plain);
      step(body);
      adapt(body);
      if (k < 64) continue;
      fewest = std::min(fewest, asleep(body).patches);
      most = std::max(most, asleep(body).patches);
    }
    CHECK(most > 0);
    CHECK(fewest < most);  // the wave went on
    // Nodes that are kept where they are miss at most `slow` for as long as a look comes late.
    CHECK(furthest_apart(plain, body) < 0.01 * largest(plain.displacements()));
  });
}

TEST_CASE("a wave goes through patches that slept as through others", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    using Quads = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
    int const cells = B::orders_by_group ? 200 : 96;  // patches of OpenMP are larger
    auto const plate = [&] {
      Body body{backend, mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {cells, cells}}), soft,
                Group<Quads>{}};
      auto v = body.velocities();
      for (std::size_t i = 0; i < v.size(); ++i) {
        auto const& p = body.mesh().nodes[i];
        double const away = std::hypot(1 - p[0], 1 - p[1]) / 0.15;
        v[i][0] = -0.05 * square(std::max(0.0, 1 - away * away));
      }
      body.set_velocities(v);
      return body;
    };
    auto plain = plate(), body = plate();
    double const dt = 0.8 * stable_step(plain);
    CentralDifference step{{.step = dt}}, same_step{{.step = dt}};
    Adaptation adapt = Adaptation{sleep({.below = 5e-4, .for_steps = 32})}.every(16);
    Index most = 0;
    for (int k = 0; k < 10; ++k) {
      step(body, 16, adapt);
      same_step(plain, 16);
      most = std::max(most, asleep(body).patches);
    }
    CHECK(most > 0);
    CHECK(furthest_apart(plain, body) < 1e-3 * largest(plain.displacements()));
  });
}

/// Of patches, as a look finds them.
template <class Parts>
std::vector<std::uint8_t> marks_of(Parts& parts, int rings) {
  detail::mark_stirred(parts, {.below = slow, .for_steps = 16}, rings);
  auto const& rows = *parts.patch_nodes;
  return rows.marks_of_patches(parts.backend, detail::MarkOfPiece{rows.stirred.data()});
}

TEST_CASE("patches are marked by how many others lie between them and what moves", "[adaptation]") {
  auto const mesh = mesh::rectangle<Tri3>({.size = {10, 1}, .cells = {10, 1}});
  Body body{SmallPatches<double, 1>{}, mesh, soft, Group<Tri>{}};
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i)
    if (mesh.nodes[i][0] == 0) v[i] = {0, 1};
  body.set_velocities(v);
  auto& parts = body.parts();
  parts.patch_nodes.emplace(detail::make_patch_nodes(parts));

  auto const marks = marks_of(parts, 3);

  // The triangles of a cell share nodes with those of the cells beside it.
  std::vector<int> by_place(marks.size());
  for (std::size_t e = 0; e < marks.size(); ++e) {
    Point<2> middle{};
    auto const& own = mesh.elements<Tri3>()[static_cast<std::size_t>(
        parts.layout.table<Tri3>().user_elements()[e])];
    for (Index node : own) middle[0] += mesh.nodes[static_cast<std::size_t>(node)][0] / 3;
    by_place[static_cast<std::size_t>(2 * middle[0])] = marks[e];
  }
  auto const cell_of = [](std::size_t place) { return static_cast<int>(place) / 2; };
  for (std::size_t place = 0; place < by_place.size(); ++place) {
    INFO(place);
    CHECK(by_place[place] == (cell_of(place) < 4 ? cell_of(place) + 1 : 0));
  }
}

/// Two bars apart in one mesh, of which the second one moves as a whole, and patches of three triangles.
inline auto two_bars() {
  auto mesh = mesh::rectangle<Tri3>({.size = {10, 1}, .cells = {10, 1}});
  auto const other = mesh::rectangle<Tri3>({.size = {10, 1}, .cells = {10, 1}, .origin = {0, 1.5}});
  auto const first = static_cast<Index>(mesh.nodes.size());
  mesh.nodes.insert(mesh.nodes.end(), other.nodes.begin(), other.nodes.end());
  for (auto element : other.elements<Tri3>()) {
    for (Index& node : element) node += first;
    mesh.elements<Tri3>().push_back(element);
  }
  Body body{SmallPatches<double, 3>{}, mesh, soft, Group<Tri>{}};
  auto v = body.velocities();
  for (std::size_t i = static_cast<std::size_t>(first); i < v.size(); ++i) v[i] = {0, 1};
  body.set_velocities(v);
  return body;
}
/// How many triangles of each patch stand still, and how many move.
template <class TheBody>
auto still_and_moving(TheBody const& body) {
  auto const& table = body.parts().layout.template table<Tri3>();
  std::vector<std::array<int, 2>> counts(static_cast<std::size_t>(table.elements.patch_count()));
  for (std::size_t e = 0; e < table.user_elements().size(); ++e)
    counts[e / 3][table.user_elements()[e] < 20 ? 0 : 1] += 1;
  return counts;
}

TEST_CASE("what moves in one body of a mesh does not reach another through patches that hold both",
          "[adaptation]") {
  auto body = two_bars();
  auto& parts = body.parts();
  parts.patch_nodes.emplace(detail::make_patch_nodes(parts));

  auto const marks = marks_of(parts, 20);

  auto const counts = still_and_moving(body);
  int both = 0, alone = 0;
  for (std::size_t p = 0; p < marks.size(); ++p) {
    INFO(p);
    auto const [still, moving] = counts[p];
    CHECK(int{marks[p]} == (moving > 0 ? 1 : 0));
    both += moving > 0 && still > 0 ? 1 : 0;
    alone += moving == 0 ? 1 : 0;
  }
  CHECK(both > 0);
  CHECK(alone > 0);
}

TEST_CASE("patches that hold parts of several bodies are awake while one of them moves",
          "[adaptation]") {
  auto body = two_bars();
  CentralDifference step;
  auto adapt = Adaptation{quick_sleep()}.every(8);
  step(body, 40, adapt);

  auto const counts = still_and_moving(body);
  auto const sleeps = asleep_elements<Tri3>(body);
  auto const& users = body.parts().layout.table<Tri3>().user_elements();
  for (std::size_t e = 0; e < users.size(); ++e) {
    INFO(e);
    CHECK(sleeps[static_cast<std::size_t>(users[e])] == (counts[e / 3][1] == 0));
  }
}

TEST_CASE("a body that is at rest sleeps as a whole, and time goes on", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = bar_on(backend);
    CentralDifference step;
    Adaptation adapt{quick_sleep()};
    step(body, 8, adapt);
    CHECK(asleep(body).patches == 0);
    step(body, 32, adapt);
    auto const found = asleep(body);
    CHECK(found.patches == found.of_patches);
    double const time = body.time();
    step(body, 100, adapt);
    CHECK(body.steps() == 140);
    CHECK(body.time() > time);
    CHECK(largest(body.displacements()) == 0);
  });
}

TEST_CASE("what something pulls at wakes, whatever it is", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const wakes = [&](char const* what, auto const& cause, bool at_once = true) {
      INFO(what);
      auto plain = bar_on(backend), body = bar_on(backend);
      hit_left_end(plain);
      hit_left_end(body);
      CentralDifference step, same_step;
      Adaptation adapt{quick_sleep()};
      settle(body, step, adapt);
      same_step(plain, 40);
      auto const before = asleep(body).patches;
      cause(plain);
      cause(body);
      if (at_once) CHECK(asleep(body).patches < before);
      for (int k = 0; k < 60; ++k) {
        same_step(plain);
        step(body);
        adapt(body);
      }
      CHECK(furthest_apart(plain, body) < 0.02 * largest(plain.displacements()));
    };
    auto const right = [](auto const& body) { return body.mesh().boundary("right"); };
    auto const last = [](auto const& body) { return nodes_of(body.mesh().boundary("right"))[0]; };
    wakes("a load on a node", [&](auto& body) { body.set_load(last(body), {0.3, 0}); });
    wakes("loads on nodes", [&](auto& body) {
      std::vector<Point<2>> loads(static_cast<std::size_t>(body.nodes()));
      loads[static_cast<std::size_t>(last(body))] = {0.3, 0};
      body.set_loads(loads);
    });
    wakes("gravity", [](auto& body) { body.set_gravity({0, -0.05}); });
    wakes("a pressure", [&](auto& body) { body.press(right(body), 0.02); });
    wakes("a motion", [&](auto& body) {
      double const start = body.time();
      body.drive(right(body), Motion<2>([start](double t) {
                   return Point<2>{0.02 * (t - start), 0};
                 }));
    });
    wakes("velocities", [](auto& body) {
      auto v = body.velocities();
      for (std::size_t i = 0; i < v.size(); ++i)
        if (body.mesh().nodes[i][0] > 19) v[i] = {-0.05, 0};
      body.set_velocities(v);
    });
    wakes("displacements", [](auto& body) {
      auto u = body.displacements();
      for (std::size_t i = 0; i < u.size(); ++i)
        if (body.mesh().nodes[i][0] > 19) u[i][0] += 0.01 * (body.mesh().nodes[i][0] - 19);
      body.set_displacements(u);
    });
    wakes("groups", [](auto& body) { body.template assign<Soft>({2300, 2301}); });
    wakes("a finer mesh", [](auto& body) { refine(body, {{2300, 2301}}); });
    wakes("a force term", [&](auto& body) {
      body.add(std::vector<std::array<Index, 1>>{{last(body)}}, Pull<double>{0.3});
    });
  });
}

TEST_CASE("what carries load sleeps until it is pulled at", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend), plain = bar_on(backend);
    CentralDifference step, same_step;
    // A wave that comes between two looks is thrown back until the next, whatever the threshold.
    Adaptation adapt = Adaptation{quick_sleep()}.every(1);
    for (auto* b : {&body, &plain}) {
      stretch(*b);
      hit_left_end(*b);
    }
    settle(body, step, adapt);
    same_step(plain, 40);
    CHECK(asleep(body).residual < 1e-3);  // N; the bar carries 0.01 and more
    auto const right = nodes_of(body.mesh().boundary("right"));
    auto const same_at_right_end = [&] {  // which sleeps, and is held
      auto const forces = body.forces(), awake = plain.forces();
      double apart = 0, most = 0;
      for (Index node : right) {
        auto const i = static_cast<std::size_t>(node);
        apart = std::max(apart, std::abs(forces[i][0] - awake[i][0]));
        most = std::max(most, std::abs(awake[i][0]));
      }
      REQUIRE(most > 1e-3);
      return apart < 1e-3 * most;
    };
    CHECK(same_at_right_end());
    for (int k = 0; k < 60; ++k) {
      (void)body.forces();  // reading changes nothing
      same_step(plain);
      step(body);
      adapt(body);
    }
    CHECK(same_at_right_end());
    CHECK(asleep(body).patches > 0);
    auto const v = plain.velocities(), w = body.velocities();
    double apart = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
      for (std::size_t k = 0; k < 2; ++k) apart = std::max(apart, std::abs(v[i][k] - w[i][k]));
    CHECK(apart < slow);
  });
}

TEST_CASE("a term of the user's own that begins to pull wakes what sleeps", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // A recording of a GPU has what pulled when it was made.
    if constexpr (std::same_as<typename B::Recording, HostRecording>) {
      auto const pulls = std::make_shared<bool>(false);
      auto body = bar_on(backend), plain = bar_on(backend);
      CentralDifference step, same_step;
      Adaptation adapt = Adaptation{quick_sleep()}.every(1);  // a look that comes late matters here
      Index const last = nodes_of(body.mesh().boundary("right"))[0];
      for (auto* b : {&body, &plain}) {
        b->add([last, pulls](B const& on, NodeRows const& rows) {
          return std::make_unique<LatePull<B>>(on, rows.of_node[static_cast<std::size_t>(last)],
                                               static_cast<Index>(rows.node.size()), pulls);
        });
        hit_left_end(*b);
      }
      settle(body, step, adapt);
      same_step(plain, 40);
      *pulls = true;
      for (int k = 0; k < 60; ++k) {
        same_step(plain);
        step(body);
        adapt(body);
      }
      CHECK(furthest_apart(plain, body) < 0.05 * largest(plain.displacements()));
    }
  });
}

TEST_CASE("nodes that are driven later on do not sleep", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend), plain = bar_on(backend);
    CentralDifference step, same_step;
    Adaptation adapt{quick_sleep()};
    for (auto* b : {&body, &plain})
      b->drive(b->mesh().boundary("right"), Motion<2>([](double t) {
                 return Point<2>{t < 1 ? 0 : 0.05 * (t - 1), 0};
               }));
    while (plain.time() < 2) {
      same_step(plain);
      step(body);
      adapt(body);
    }
    CHECK(asleep(body).patches > 0);
    CHECK(asleep(body).patches < asleep(body).of_patches);
    CHECK(furthest_apart(plain, body) < 0.01 * largest(plain.displacements()));
  });
}

TEST_CASE("nodes are taken for driven from when they are until they are released", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend);
    CentralDifference step;
    Adaptation adapt{quick_sleep()};
    step(body, 40, adapt);
    CHECK(asleep(body).patches == asleep(body).of_patches);
    auto const handle =
        body.drive(body.mesh().boundary("right"), Motion<2>([](double) { return Point<2>{}; }));
    step(body, 40, adapt);
    CHECK(asleep(body).patches > 0);
    CHECK(asleep(body).patches < asleep(body).of_patches);
    body.release(handle);
    step(body, 40, adapt);
    CHECK(asleep(body).patches > 0);
    CHECK(asleep(body).patches == asleep(body).of_patches);
  });
}

TEST_CASE("a pressure beside sleeping patches is felt, and the neighbours of what moves wake",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend), plain = bar_on(backend);
    for (auto* b : {&body, &plain}) {
      b->press(b->mesh().boundary("right"), 1e-7);
      hit_left_end(*b);
    }
    CentralDifference step, same_step;
    Adaptation adapt{quick_sleep()};
    settle(body, step, adapt);
    for (int k = 0; k < 500; ++k) {
      step(body);
      adapt(body);
    }
    same_step(plain, 540);
    CHECK(furthest_apart(plain, body) < 0.01 * largest(plain.displacements()));
  });
}

TEST_CASE("what sleep takes is booked, and its residual told", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend);
    hit_left_end(body);
    body.set_damping(2);
    CentralDifference step{{.safety = 0.3}};
    Adaptation adapt{sleep({.below = 5e-3, .for_steps = 16})};
    double const begin = total_energy(body);
    auto const kept_less_booked = [&] {
      return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
    };
    int changes = 0;
    for (int k = 0; k < 90; ++k) {
      step(body, 8);
      double const before = kept_less_booked();
      auto const slept = asleep(body).patches;
      adapt.now(body);
      changes += asleep(body).patches != slept;
      CHECK(std::abs(kept_less_booked() - before) < 1e-13 * begin);
    }
    REQUIRE(changes > 1);
    auto const found = asleep(body);
    CHECK(found.energy < 0);
    double const kept = leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
    CHECK(std::abs(kept - begin) < 1e-3 * begin);
    CHECK(std::abs(kept - found.energy - begin) > 1e-3 * std::abs(found.energy));
    bool told = false;
    for (auto const& entry : ledger(body))
      told = told || (entry.action == "sleep" && entry.kinetic_energy == found.energy);
    CHECK(told);
    // A node would not gain the threshold within for_steps, up to the next look.
    auto const& mass = body.parts().layout.mass_list();
    CHECK(found.residual <= 2 * 5e-3 * *std::ranges::max_element(mass) / (16 * step.step()));
  });
}

TEST_CASE("a body with sleeping patches is saved and rolled back", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend), again = bar_on(backend);
    hit_left_end(body);
    CentralDifference step{{.check_interval = 24}};
    Adaptation adapt{quick_sleep()}, same{quick_sleep()};
    settle(body, step, adapt);
    std::stringstream stream;
    body.save(stream);
    again.load(stream);
    CHECK(asleep(again).patches == asleep(body).patches);
    CentralDifference other{{.check_interval = 24}};
    for (int k = 0; k < 100; ++k) {
      step(body);
      adapt(body);
      other(again);
      same(again);
    }
    CHECK(first_difference(body.state(), again.state()) == "");

    // A roll-back to where patches slept that are awake now.
    keep_checkpoint(body.parts());
    auto const slept = asleep(body).patches;
    wake_all(body.parts());
    REQUIRE(asleep(body).patches == 0);
    roll_back(body.parts());
    CHECK(asleep(body).patches == slept);

    // Four times the stable step: rolled back to where patches slept.
    CentralDifference large{{.step = 4 * step.step(), .check_interval = 24}};
    Advanced advanced;
    for (int k = 0; k < 3 && large.retries() == 0; ++k) advanced = large(body, 24);
    CHECK(large.retries() > 0);
    CHECK(std::isfinite(largest(body.displacements())));
  });
}

TEST_CASE("reading forces of a body with sleeping patches gives those of all", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = bar_on(backend), read = bar_on(backend), plain = bar_on(backend);
    for (auto* b : {&body, &read, &plain}) stretch(*b);  // what sleeps carries load
    for (auto* b : {&body, &read}) hit_left_end(*b);
    CentralDifference step, same_step;
    Adaptation adapt{quick_sleep()}, same{quick_sleep()};
    int reads_of_sleepers = 0;
    for (int k = 0; k < 200; ++k) {
      step(body);
      adapt(body);
      same_step(read);
      same(read);
      if (k % 7 == 0) {
        plain.set_displacements(read.displacements());
        CHECK(read.forces() == plain.forces());
        reads_of_sleepers += asleep(read).patches > 0;
      }
    }
    CHECK(reads_of_sleepers > 2);
    (void)body.forces();
    CHECK(furthest_apart(body, read) < 1e-12 * largest(body.displacements()));
  });
}

TEST_CASE("where nobody looks any more, and under another integrator, all wakes", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (bool other_integrator : {false, true}) {
      auto body = bar_on(backend), plain = bar_on(backend);
      for (auto* b : {&body, &plain}) hit_left_end(*b);
      CentralDifference step, same_step;
      Adaptation adapt{quick_sleep()};
      settle(body, step, adapt);
      same_step(plain, 40);
      if (other_integrator) {
        LocalSteps local, same_local;
        local(body, 20);
        same_local(plain, 20);
      } else {
        step(body, 200);
        same_step(plain, 200);
      }
      CHECK(asleep(body).patches == 0);
      CHECK(furthest_apart(plain, body) < 0.02 * largest(plain.displacements()));
    }
  });
}

TEST_CASE("sleep refuses what it cannot take", "[adaptation]") {
  CHECK_THROWS_WITH(sleep({.below = 0}), says("below is 0 m/s"));
  CHECK_THROWS_WITH(sleep({.below = 1, .for_steps = 0}), says("for_steps is 0"));
}

}  // namespace pliant::test::sleep_suite

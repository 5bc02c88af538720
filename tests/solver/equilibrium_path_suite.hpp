#pragma once

#include <pliant/solver/equilibrium_path.hpp>
#include <pliant/solver/newton.hpp>

#include "support/formulations.hpp"

// Paths of equilibria through limit points.
namespace pliant::test::equilibrium_path_suite {

using Rubber = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
inline constexpr Elastic rubber{1e6, 0.3, 1000};

/// A shallow arch, 1 m wide, clamped at both ends.
inline Mesh<Quad9> arch() {
  auto mesh = mesh::rectangle<Quad9>({.size = {1, 0.02}, .cells = {16, 1}});
  for (auto& x : mesh.nodes) x[1] += 0.08 * 4 * x[0] * (1 - x[0]);
  return mesh;
}
inline Index crown(Mesh<Quad9> const& mesh) {
  Index best = 0;
  auto const off = [&](Index i) {
    auto const& x = mesh.nodes[static_cast<std::size_t>(i)];
    return std::abs(x[0] - 0.5) + std::abs(x[1] - 0.1);
  };
  for (Index i = 0; i < static_cast<Index>(mesh.nodes.size()); ++i)
    if (off(i) < off(best)) best = i;
  return best;
}
template <class B>
auto clamped_arch(B const& backend) {
  auto const mesh = arch();
  Body body{backend, mesh, rubber, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.clamp(mesh.boundary("right"));
  return body;
}

struct Seen {
  std::vector<PathPoint> points;
  std::vector<double> down;  // of the crown, m
};
template <class TheBody>
Seen follow(TheBody& body, PathOptions const& options, PathReport& report) {
  Seen seen;
  auto const top = static_cast<std::size_t>(crown(body.mesh()));
  report = follow_path(body, options, [&](PathPoint const& point) {
    seen.points.push_back(point);
    seen.down.push_back(-body.displacements()[top][1]);
    return true;
  });
  return seen;
}
constexpr double pull = 40;  // N/m, above the limit point

TEST_CASE("an arch snaps through along its equilibria", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = clamped_arch(backend);
    body.set_load(crown(body.mesh()), {0, -pull});
    PathReport report;
    auto const seen = follow(body, {.first = 0.1, .longest = 1}, report);

    REQUIRE(report.end == PathEnd::reached);
    CHECK(report.points == std::ssize(seen.points));
    CHECK(report.last.share == 1);
    CHECK(seen.points.front().stable);
    CHECK(seen.points.back().stable);
    // Up to a limit point, down while it is unstable, and up again.
    int falling = 0, unstable = 0, unstable_and_falling = 0;
    double work = 0;
    for (std::size_t k = 0; k < seen.points.size(); ++k) {
      auto const& now = seen.points[k];
      double const before = k ? seen.points[k - 1].share : 0, under = k ? seen.down[k - 1] : 0;
      falling += now.share < before;
      unstable += !now.stable;
      unstable_and_falling += !now.stable && now.share < before;
      CHECK(seen.down[k] > under);
      work += pull * (now.share + before) / 2 * (seen.down[k] - under);
      CHECK(now.energy == Approx(work).epsilon(0.02).margin(0.01));
    }
    CHECK(falling >= 3);
    CHECK(unstable >= falling - 1);
    CHECK(unstable_and_falling >= falling - 1);
    CHECK(seen.down.back() > 0.14);
    for (auto const& point : seen.points) CHECK(point.share <= 1);
    // At rest under all of its load, where a single step of Newton's method would not have led.
    CHECK(solve_static(body, {.tolerance = 1e-8}).iterations == 0);
    CHECK(strain_energy(body) == Approx(report.last.energy).epsilon(1e-9));
  });
}

TEST_CASE("arcs of other lengths lead along the same path", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    std::vector<double> limits, ends;
    for (double first : {0.1, 0.2}) {
      auto body = clamped_arch(backend);
      body.set_load(crown(body.mesh()), {0, -pull});
      PathReport report;
      auto const seen = follow(body, {.first = first, .longest = 1}, report);
      REQUIRE(report.end == PathEnd::reached);
      double limit = 0;
      for (std::size_t k = 0; k + 1 < seen.points.size(); ++k)
        if (seen.points[k + 1].share < seen.points[k].share) {
          limit = seen.points[k].share;
          break;
        }
      limits.push_back(limit);
      ends.push_back(seen.down.back());
    }
    CHECK(limits[0] > 0.1);
    CHECK(limits[0] < 0.9);
    CHECK(limits[1] == Approx(limits[0]).epsilon(0.02));
    CHECK(ends[1] == Approx(ends[0]).epsilon(1e-8));
  });
}

TEST_CASE("a path leads where load steps lead, by motions, pressures and weight too", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const make = [&](int what) {
      auto const mesh = mesh::rectangle<Quad9>({.size = {1, 0.1}, .cells = {8, 1}});
      Body body{backend, mesh, rubber, Group<Rubber>{}};
      body.clamp(mesh.boundary("left"));
      if (what == 0) body.drive(mesh.boundary("right"), [](double) { return Point<2>{-0.1, 0.3}; });
      if (what == 1) body.press(mesh.boundary("bottom"), 300);
      if (what == 2) body.set_gravity({0, -4});
      return body;
    };
    for (int what : {0, 1, 2}) {
      auto one = make(what), other = make(what);
      auto const report = follow_path(one, {}, [](PathPoint const&) { return true; });
      CHECK(report.end == PathEnd::reached);
      CHECK(report.points > 2);
      solve_static(other, {.load_steps = 5});
      double const size = largest(other.displacements());
      CHECK(size > 0.05);
      CHECK(difference(one.displacements(), other.displacements()) < 1e-7 * size);
    }
  });
}

TEST_CASE("a path ends where it is told to, and says why", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = clamped_arch(backend);
    CHECK_THROWS_WITH(follow_path(body, {}, [](PathPoint const&) { return true; }),
                      says("no load, pressure, weight or motion grows"));
    body.set_load(crown(body.mesh()), {0, -pull});
    CHECK_THROWS_WITH(follow_path(body, {.first = 0}, [](PathPoint const&) { return true; }),
                      says("first 0"));
    CHECK(largest(body.displacements()) == 0);
    auto report =
        follow_path(body, {.first = 0.1}, [](PathPoint const& p) { return p.share < 0.1; });
    CHECK(report.end == PathEnd::stopped);
    CHECK(report.last.share >= 0.1);
    CHECK(report.last.share < 0.4);
    // From there on, the rest of the load grows.
    report =
        follow_path(body, {.first = 0.1, .max_points = 2}, [](PathPoint const&) { return true; });
    CHECK(report.end == PathEnd::most_points);
    CHECK(report.points == 2);
    report = follow_path(body, {.first = 0.1, .max_iterations = 1, .tolerance = 1e-15},
                         [](PathPoint const&) { return true; });
    CHECK(report.end == PathEnd::lost);
    CHECK(report.points == 0);
  });
}

}  // namespace pliant::test::equilibrium_path_suite

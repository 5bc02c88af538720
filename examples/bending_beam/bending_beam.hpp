#pragma once

#include <chrono>
#include <cstdio>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#include <pliant/solver/newton.hpp>

#include "scene/drawing.hpp"
#include "scene/options.hpp"

// Fig. 2 of Caillaud et al. 2013: a cantilever bends under gravity and comes to rest. Hooke's law is
// cheap and right while nothing turns; elements that stretch or turn switch to Saint Venant-Kirchhoff.
namespace bending_beam {

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Nonlinear = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

inline constexpr Elastic rubber{.young = 2e6, .poisson = 0.3, .density = 1e3};  // Pa, -, kg/m³
inline constexpr double duration = 4;                                           // s
inline constexpr double damping = 8;       // 1/s: a little below critical, so that it comes to rest
inline constexpr double leave = 0.10;      // criterion above which an element leaves Hooke
inline constexpr double come_back = 0.05;  // and below which it returns
inline constexpr int check_interval = 8;   // steps
inline constexpr int frames = 6;

enum class Run { hooke, saint_venant_kirchhoff, adaptive };

/// What one run of the scene came to.
struct Outcome {
  Point<2> tip;  // displacement, m
  double error;  // of the tip against static Saint Venant-Kirchhoff, share of its length
  double total;  // s, wall clock
  double forces, criteria, migration;  // s, by the backend's timer
  double share_of_hooke;               // of element-steps
  double switches;
  int most_switches;     // of one element
  double late_switches;  // in the last tenth
  long steps;
  std::vector<LedgerEntry<2>> ledger;
  std::vector<picture::Frame> pictures;
};

template <class TheBody>
void prepare(TheBody& body) {
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -10});
}

inline Index tip_node(Mesh<Quad4> const& mesh) {
  auto const right = nodes_of(mesh.boundary("right"));
  return right[right.size() / 2];
}

/// Where the tip rests under a law, from Newton's method on the same mesh.
template <class F>
Point<2> static_tip(Mesh<Quad4> const& mesh) {
  Body body{Reference<double>{}, mesh, rubber, Group<F>{}};
  prepare(body);
  solve_static(body, {.load_steps = 4});
  return body.displacements()[static_cast<std::size_t>(tip_node(mesh))];
}

inline double switch_count(std::vector<LedgerEntry<2>> const& ledger) {
  double sum = 0;
  for (auto const& entry : ledger) sum += entry.elements;
  return sum;
}

inline double distance(Point<2> const& a, Point<2> const& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

template <class TheBackend>
Outcome simulate(TheBackend const& backend, Mesh<Quad4> const& mesh, Run run,
                 Point<2> const& at_rest) {
  auto const criterion = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
  Adaptation adapt{when<Linear>(criterion).above(leave).template become<Nonlinear>(),
                   when<Nonlinear>(criterion).below(come_back).template become<Linear>()};
  CentralDifference step;
  Body beam{backend, mesh, rubber, Group<Linear>{}, Group<Nonlinear>{}};
  prepare(beam);
  beam.set_damping(damping);
  if (run == Run::saint_venant_kirchhoff) {
    std::vector<Index> all(mesh.elements<Quad4>().size());
    std::iota(all.begin(), all.end(), 0);
    beam.template assign<Nonlinear>(all);
  }

  Outcome outcome{};
  auto timer = backend.timer();
  measure_adaptation(beam);
  double late = 0;
  auto const draw = [&](int frame) {
    auto const colour = evaluate<Quad4>(beam, largest(EdgeLengthRatio{}, AreaRatio{}));
    auto const groups = beam.template groups_of<Quad4>();
    char caption[64];
    std::snprintf(caption, sizeof caption, "(%c) t = %.2f s", 'a' + frame, beam.time());
    outcome.pictures.push_back(scene::draw<Quad4>(beam, caption, [&](std::size_t e) {
      return groups[e] == 1 ? picture::blue : picture::green_to_red(colour[e]);
    }));
  };
  auto const begin = std::chrono::steady_clock::now();
  double drawing = 0;
  // Frames while it falls, and at rest.
  constexpr double frame_times[frames] = {0, 0.15, 0.25, 0.35, 0.6, duration};
  int frame = 0;
  while (beam.time() < duration) {
    if (run == Run::adaptive && beam.time() >= frame_times[frame]) {
      auto const since = std::chrono::steady_clock::now();
      draw(frame++);
      std::printf("  adaptive, t = %.2f s of %.0f s\n", beam.time(), duration);
      std::fflush(stdout);
      drawing += std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
    }
    if (late == 0 && beam.time() >= 0.9 * duration) late = switch_count(ledger(beam)) + 1;
    timer.start();
    step(beam, check_interval);
    timer.stop();
    if (run == Run::adaptive) adapt.now(beam);
  }
  backend.synchronize();
  outcome.total =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() - drawing;
  if (run == Run::adaptive) draw(frame);

  outcome.tip = beam.displacements()[static_cast<std::size_t>(tip_node(mesh))];
  outcome.error = distance(outcome.tip, at_rest) / distance(at_rest, {0, 0});
  outcome.forces = timer.seconds();
  outcome.criteria = beam.parts().timers.criteria.seconds();
  outcome.migration = beam.parts().timers.migration.seconds();
  auto const share = element_steps<Quad4>(beam);
  outcome.share_of_hooke = share[0] / (share[0] + share[1]);
  outcome.ledger = ledger(beam);
  outcome.switches = switch_count(outcome.ledger);
  outcome.late_switches = outcome.switches - (late - 1);
  for (int count : switch_counts<Quad4>(beam))
    outcome.most_switches = std::max(outcome.most_switches, count);
  outcome.steps = beam.steps();
  return outcome;
}

inline void print(char const* name, Outcome const& o) {
  std::printf("%-22s %9.5f %9.5f %8.3f%% %8ld %8.3f %8.4f %8.4f %8.3f %7.1f%% %8.0f %5d %5.0f\n",
              name, o.tip[0], o.tip[1], 100 * o.error, o.steps, o.forces, o.criteria, o.migration,
              o.total, 100 * o.share_of_hooke, o.switches, o.most_switches, o.late_switches);
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const across = options.cells > 0 ? options.cells : 8;
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {10 * across, across}});  // m
  auto const hooke_at_rest = static_tip<Linear>(mesh);
  auto const at_rest = static_tip<Nonlinear>(mesh);

  std::printf("Bending beam on %s: 1 m x 0.1 m, %zu Quad4 elements, E = 2 MPa, nu = 0.3\n",
              TheBackend::name(), mesh.elements<Quad4>().size());
  auto const hooke = simulate(backend, mesh, Run::hooke, at_rest);
  auto const exact = simulate(backend, mesh, Run::saint_venant_kirchhoff, at_rest);
  auto const adaptive = simulate(backend, mesh, Run::adaptive, at_rest);

  std::printf("\n%-22s %9s %9s %9s %8s %8s %8s %8s %8s %8s %8s %5s %5s\n", "", "tip x/m", "tip y/m",
              "error", "steps", "forces/s", "crit./s", "migr./s", "total/s", "Hooke", "switches",
              "most", "late");
  std::printf("%-22s %9.5f %9.5f %8.3f%%\n", "static, Hooke", hooke_at_rest[0], hooke_at_rest[1],
              100 * distance(hooke_at_rest, at_rest) / distance(at_rest, {0, 0}));
  std::printf("%-22s %9.5f %9.5f %8.3f%%\n", "static, StVK", at_rest[0], at_rest[1], 0.0);
  print("all Hooke", hooke);
  print("all StVK", exact);
  print("adaptive", adaptive);
  double const overhead = adaptive.criteria + adaptive.migration;
  std::printf("adaptation takes %.1f%% of the adaptive run (%.1f%% of forces and adaptation)\n",
              100 * overhead / adaptive.total, 100 * overhead / (overhead + adaptive.forces));
  for (auto const& entry : adaptive.ledger)
    std::printf("ledger: %s: %.0f elements, strain energy %+.4f J\n", entry.action.c_str(),
                entry.elements, entry.strain_energy);

  auto const path = options.output / "bending_beam.png";
  picture::write_strip(path, adaptive.pictures,
                       {.title = "A cantilever bends under gravity; its elements change law",
                        .columns = 3,
                        .colour_bar = {"max(R_L, R_A) under Hooke"},
                        .legend = {{"Saint Venant–Kirchhoff", picture::blue}},
                        .length_unit = "m"});
  std::printf("picture: %s\n", path.string().c_str());
}

}  // namespace bending_beam

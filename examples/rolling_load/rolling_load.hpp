#pragma once

#include <chrono>
#include <cstdio>

#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>

#include "picture/strip.hpp"
#include "scene/options.hpp"
#include "scene/solid_drawing.hpp"

// A load rolls over a block with a notch in its bottom. Elements that contribute more than a tolerance to the energy of the error, as
// they do under the load, are refined; behind it they are merged again.
namespace rolling_load {

using namespace pliant;

using F = Formulation<Hex8, Gauss<2>, Hooke>;

inline constexpr Elastic steel{.young = 2e11, .poisson = 0.3, .density = 7.8e3};  // Pa, -, kg/m³
inline constexpr double length = 4;                                               // m
inline constexpr double patch = 0.3;                                // m: half the width of the load
inline constexpr double peak = 5e6;                                 // Pa: in the middle of the load
inline constexpr double places[] = {0.5, 1.1, 1.7, 2.3, 2.9, 3.5};  // m: where the load stands
inline constexpr int rounds = 3;                                    // of adaptation at each place
inline constexpr int max_level = 3;
inline constexpr int uniform_level = 2;

/// The block without its notch, n cells high.
inline Mesh<Hex8> block(int n) {
  auto const whole = mesh::box({.size = {length, 1, 1}, .cells = {4 * n, n, n}});
  Mesh<Hex8> mesh;
  std::vector<Index> number(whole.nodes.size(), -1);
  for (auto element : whole.elements<Hex8>()) {
    auto const& low = whole.nodes[static_cast<std::size_t>(element[0])];
    if (std::abs(low[0] + 0.5 / n - length / 2) < 0.6 / n && low[2] < 0.4) continue;
    for (Index& node : element) {
      Index& own = number[static_cast<std::size_t>(node)];
      if (own < 0) {
        own = static_cast<Index>(mesh.nodes.size());
        mesh.nodes.push_back(whole.nodes[static_cast<std::size_t>(node)]);
      }
      node = own;
    }
    mesh.elements<Hex8>().push_back(element);
  }
  mesh.boundaries["skin"] = mesh::outer_sides(mesh);
  mesh.boundaries["top"] =
      mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[2] == 1; });
  mesh.boundaries["feet"] = mesh::outer_sides_where(mesh, [n](Point<3> const& p) {
    double const foot = 1.0 / n;
    return p[2] == 0 && (p[0] <= foot || p[0] >= length - foot);
  });
  return mesh;
}

/// Of the load at one place: what it took, and what was left of the error.
struct Answer {
  double seconds = 0;
  std::size_t elements = 0;
  long unknowns = 0;
  double error = 0, energy = 0;  // J
};

template <class TheBody>
NewtonReport solve_at(TheBody& body, double place) {
  body.set_loads(
      traction_loads(body.mesh(), body.mesh().boundary("top"), [place](Point<3> const& p) {
        double const from = (p[0] - place) / patch;
        return Point<3>{0, 0, -peak * std::max(0.0, 1 - from * from)};
      }));
  return solve_static(body);
}

/// Moves the load to a place; changes(body, round) adapts the mesh and says whether another round is needed.
template <class TheBody, class Changes>
Answer move_to(TheBody& body, double place, Changes const& changes) {
  Answer answer;
  auto const begin = std::chrono::steady_clock::now();
  for (int round = 0;; ++round) {
    auto const report = solve_at(body, place);
    answer.unknowns = report.unknowns;
    answer.energy = report.energy;
    if (!changes(body, round)) break;
  }
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  answer.error = estimate(body, RecoveredStress{});
  answer.elements = body.mesh().template elements<Hex8>().size();
  return answer;
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const cells = options.cells > 0 ? options.cells : 4;
  auto const made = [&](Mesh<Hex8> const& mesh) {
    Body body{backend, mesh, steel, Group<F>{}};
    body.clamp(mesh.boundary("feet"));
    return body;
  };
  auto adaptive = made(block(cells));
  auto uniform = made(block(cells << uniform_level));
  // An element's error falls to 1/32 when it becomes eight: merging asks for less than that of eight times the tolerance.
  double const most = 1.2e-3;  // J, of one element
  Adaptation adapt{when<F>(RecoveredStress{}).above(most).refine({.max_level = max_level}),
                   when<F>(RecoveredStress{}).below(most / 64).coarsen()};
  auto const adapts = [&](auto& body, int round) {
    if (round == rounds) return false;
    auto const nodes = body.nodes();
    adapt.now(body);
    return body.nodes() != nodes;
  };
  auto const stays = [](auto const&, int) { return false; };

  std::printf("Rolling load on %s: a notched block of 4 m x 1 m x 1 m, Hex8\n", TheBackend::name());
  std::printf("%6s | %9s %9s %8s %7s | %9s %9s %8s %7s\n", "load/m", "adaptive", "unknowns",
              "error", "s", "uniform", "unknowns", "error", "s");
  std::vector<picture::Frame> frames;
  double seconds[2] = {0, 0};
  for (double place : places) {
    auto const own = move_to(adaptive, place, adapts);
    auto const other = move_to(uniform, place, stays);
    seconds[0] += own.seconds;
    seconds[1] += other.seconds;
    auto const percent = [](Answer const& a) { return 100 * std::sqrt(a.error / a.energy); };
    std::printf("%6.1f | %9zu %9ld %7.2f%% %7.3f | %9zu %9ld %7.2f%% %7.3f\n", place, own.elements,
                own.unknowns, percent(own), own.seconds, other.elements, other.unknowns,
                percent(other), other.seconds);
    auto const levels = refinement_levels<Hex8>(adaptive);
    char caption[96];
    std::snprintf(caption, sizeof caption,
                  "(%c) %zu elements, error %.1f %%, %.2f s\nuniform: %zu, %.1f %%, %.2f s",
                  static_cast<char>('a' + frames.size()), own.elements, percent(own), own.seconds,
                  other.elements, percent(other), other.seconds);
    frames.push_back(scene::draw_solid<Hex8>(
        adaptive, adaptive.mesh().boundary("skin"), 2e3,
        [&](std::size_t e) { return picture::green_to_red(double(levels[e]) / max_level); }));
    frames.back().caption = caption;
  }
  std::printf("all places: %.2f s adaptive, %.2f s on the uniform mesh\n", seconds[0], seconds[1]);

  auto const path = options.output / "rolling_load.png";
  picture::write_strip(path, frames,
                       {.title = "The mesh follows a load that rolls over a block",
                        .columns = 2,
                        .colour_bar = {.label = "level", .lowest = 0, .highest = max_level},
                        .length_unit = "m"});
  std::printf("picture: %s\n", path.string().c_str());
}

}  // namespace rolling_load

#pragma once

#include <chrono>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "picture/film.hpp"
#include "scene/carve.hpp"
#include "scene/options.hpp"
#include "scene/solid_drawing.hpp"

// An L-shaped beam of tetrahedra hangs from its top and is let go. Elements that contribute more than a tolerance to the energy of the
// error are divided into eight, and merged again while the beam swings back.
namespace l_beam {

using namespace pliant;

using F = Formulation<Tet4, Gauss<1>, NeoHookean>;

inline constexpr Elastic rubber{.young = 1e6, .poisson = 0.3, .density = 1e3};  // Pa, -, kg/m³
inline constexpr double thick = 0.2;       // m: of both legs; each reaches 1 m from end to end
inline constexpr double damping = 0.5;     // 1/s
inline constexpr double tolerance = 4e-3;  // J, of one element
inline constexpr int max_level = 2;
inline constexpr int look_interval = 128;  // steps
inline constexpr double duration = 1.8;    // s: one swing
inline constexpr int drawings = 36;
inline constexpr int drawn_apart = 6;  // of them in the strip

enum class Run { coarse, adaptive, uniform };

/// What one run of the scene came to, up to each drawing.
struct Outcome {
  std::vector<Point<3>> tip;    // displacement, m
  std::vector<double> seconds;  // wall clock, without drawing
  std::vector<std::size_t> elements, nodes;
  std::vector<picture::Frame> frames;  // of the adaptive run
  double evaluations = 0;              // of elements
};

/// n cells thick.
inline Mesh<Tet4> beam(int n) {
  auto const is_gone = [](Point<3> const& middle) {
    return middle[0] > thick && middle[2] > thick;
  };
  auto mesh =
      scene::carve(mesh::box<Tet4>({.size = {1, thick, 1}, .cells = {5 * n, n, 5 * n}}), is_gone);
  mesh.boundaries["top"] =
      mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[2] == 1; });
  return mesh;
}

/// Of the lower corner in front, at the end of the lying leg. Refinement may number nodes anew.
template <class TheBody>
Point<3> tip_displacement(TheBody const& body) {
  auto const& nodes = body.mesh().nodes;
  auto const tip = std::ranges::min_element(
      nodes, {}, [](Point<3> const& p) { return std::hypot(p[0] - 1, p[1], p[2]); });
  return body.displacements()[static_cast<std::size_t>(tip - nodes.begin())];
}

template <class TheBody>
picture::Frame draw(TheBody const& body) {
  auto const levels = refinement_levels<Tet4>(body);
  return scene::draw_solid<Tet4>(body, body.mesh().boundary("skin"), 1, [&](std::size_t e) {
    return picture::green_to_red(double(levels[e]) / max_level);
  });
}

template <class TheBackend>
Outcome simulate(TheBackend const& backend, Mesh<Tet4> const& mesh, Run run) {
  Body body{backend, mesh, rubber, Group<F>{}};
  body.clamp(mesh.boundary("top"));
  body.set_gravity({0, 0, -9.81});
  body.set_damping(damping);
  Adaptation adapt{when<F>(RecoveredStress{}).above(tolerance).refine({.max_level = max_level}),
                   when<F>(RecoveredStress{}).below(tolerance / 40).coarsen()};
  adapt.every(look_interval);
  CentralDifference step;

  Outcome outcome;
  double seconds = 0;
  for (int k = 0; k < drawings; ++k) {
    auto const begin = std::chrono::steady_clock::now();
    while (body.time() < duration * k / (drawings - 1))
      if (run == Run::adaptive)
        step(body, 8, adapt);
      else
        step(body, 8);
    backend.synchronize();
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

    outcome.seconds.push_back(seconds);
    outcome.tip.push_back(tip_displacement(body));
    outcome.elements.push_back(body.mesh().template elements<Tet4>().size());
    outcome.nodes.push_back(body.mesh().nodes.size());
    if (run == Run::adaptive) outcome.frames.push_back(draw(body));
  }
  outcome.evaluations = element_steps<Tet4>(body)[0];
  return outcome;
}

/// The largest distance of the tip from that of another run, share of the largest displacement there.
inline double error_of(Outcome const& run, Outcome const& other) {
  double farthest = 0, largest = 0;
  for (std::size_t k = 0; k < run.tip.size(); ++k) {
    auto const &a = run.tip[k], &b = other.tip[k];
    farthest = std::max(farthest, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    largest = std::max(largest, std::hypot(b[0], b[1], b[2]));
  }
  return farthest / largest;
}

inline void print(char const* name, Outcome const& run, Outcome const& uniform) {
  auto const [fewest, most] = std::ranges::minmax(run.elements);
  std::printf("%-10s %9zu %9zu %14.3g %9.2f %11.1f%%\n", name, fewest, most, run.evaluations,
              run.seconds.back(), 100 * error_of(run, uniform));
}

inline void check(bool holds, char const* what) {
  if (!holds) throw Error("L-shaped beam: ", what);
}

inline void check(Outcome const& adaptive, Outcome const& uniform) {
  check(error_of(adaptive, uniform) < 0.15,
        "the tip of the adaptive run strays by 0.15 from that on the uniform mesh");
  check(adaptive.evaluations < 0.6 * uniform.evaluations,
        "the adaptive run evaluates more than 0.6 of the elements of that on the uniform mesh");
  check(10 * std::ranges::max(adaptive.elements) > 11 * adaptive.elements.back(),
        "the mesh does not coarsen while the beam swings back");
}

inline void write_pictures(Outcome adaptive, Outcome const& uniform,
                           std::filesystem::path const& folder) {
  std::vector<picture::Frame> strip;
  for (std::size_t k = 0; k < adaptive.frames.size(); ++k) {
    double const time = duration * static_cast<double>(k) / (drawings - 1);
    auto& frame = adaptive.frames[k];
    char caption[128];
    if (k % drawn_apart == drawn_apart - 1) {
      std::snprintf(caption, sizeof caption,
                    "(%c) t = %.2f s: %zu elements, %.2f s\nuniform: %zu, %.2f s",
                    static_cast<char>('a' + strip.size()), time, adaptive.elements[k],
                    adaptive.seconds[k], uniform.elements[k], uniform.seconds[k]);
      frame.caption = caption;
      strip.push_back(frame);
    }
    std::snprintf(caption, sizeof caption, "t = %.2f s: %zu elements, %zu nodes, %.2f s", time,
                  adaptive.elements[k], adaptive.nodes[k], adaptive.seconds[k]);
    frame.caption = caption;
  }
  picture::Options look{.title = "An L-shaped beam swings; its mesh refines and coarsens",
                        .columns = 3,
                        .colour_bar = {.label = "level", .lowest = 0, .highest = max_level},
                        .length_unit = "m"};
  auto const path = folder / "l_beam.png";
  picture::write_strip(path, strip, look);
  std::printf("picture: %s\n", path.string().c_str());
  look.title = "An L-shaped beam swings";
  picture::write_film(folder / "film", adaptive.frames, look);
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const cells = options.cells > 0 ? options.cells : 2;
  std::printf("L-shaped beam on %s: 1 m x 0.2 m x 1 m, Tet4, %g s of a swing\n", TheBackend::name(),
              duration);
  auto const coarse = simulate(backend, beam(cells), Run::coarse);
  auto const adaptive = simulate(backend, beam(cells), Run::adaptive);
  auto const uniform = simulate(backend, beam(cells << max_level), Run::uniform);
  std::printf("%-10s %9s %9s %14s %9s %12s\n", "", "elements", "at most", "evaluations", "time/s",
              "tip's error");
  print("coarse", coarse, uniform);
  print("adaptive", adaptive, uniform);
  print("uniform", uniform, uniform);
  std::printf("adaptive: %.2f of the uniform mesh's evaluations of elements, in %.2f of the time\n",
              adaptive.evaluations / uniform.evaluations,
              adaptive.seconds.back() / uniform.seconds.back());
  write_pictures(adaptive, uniform, options.output);
  // The tolerance was chosen for the scene's own cells.
  if (options.cells == 0) check(adaptive, uniform);
}

}  // namespace l_beam

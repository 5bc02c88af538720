#pragma once

#include <chrono>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "scene/drawing.hpp"
#include "scene/options.hpp"

// A large sheet is struck at a corner, rings and comes to rest. Ogden's law is right for rubber and costs several times
// as much as Saint Venant-Kirchhoff's, which will do where strains are small; what is at rest sleeps.
namespace struck_corner {

using namespace pliant;

using Cheap = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Costly = Formulation<Quad4, Gauss<2>, Ogden>;

inline constexpr Elastic rubber{.young = 2e6, .poisson = 0.3, .density = 1e3};  // Pa, -, kg/m³
inline constexpr double side = 2;                                               // m
inline constexpr double struck = 0.3;  // m: of the corner that is struck
inline constexpr double damping = 80;  // 1/s
inline constexpr double leave = 0.02;  // norm of the strain above which an element becomes Costly
inline constexpr double come_back = 0.01;  // and below which it returns
inline constexpr double at_rest = 0.03;    // m/s; the blow has 6
inline constexpr double frame_times[] = {0.004, 0.012, 0.02, 0.05, 0.15, 0.25};  // s

enum class Run { costly, adaptive };

/// What one run of the scene came to, up to each frame.
struct Outcome {
  std::vector<Point<2>> corner;       // displacement, m
  std::vector<double> seconds;        // wall clock, without drawing
  std::vector<double> awake, costly;  // shares
  std::vector<std::vector<picture::Polygon>> drawings;
  long steps = 0;
};

/// A blow that fades out along the sheet.
template <class TheBody>
void strike(TheBody& body) {
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) {
    auto const& p = body.mesh().nodes[i];
    double const from_corner = std::hypot(side - p[0], side - p[1]) / struck;
    if (from_corner < 1) v[i] = {-6 * (1 - from_corner), -6 * (1 - from_corner)};
  }
  body.set_velocities(v);
}

inline Index corner_node(Mesh<Quad4> const& mesh) {
  Index found = 0;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i][0] + mesh.nodes[i][1] > 2 * side - 1e-9) found = static_cast<Index>(i);
  return found;
}

template <class TheBackend>
Outcome simulate(TheBackend const& backend, Mesh<Quad4> const& mesh, Run run) {
  Body sheet{backend, mesh, rubber, Group<Cheap>{}, Group<Costly>{}};
  for (char const* held : {"left", "bottom"}) sheet.clamp(mesh.boundary(held));
  sheet.set_damping(damping);
  strike(sheet);
  if (run == Run::costly) {
    std::vector<Index> all(mesh.elements<Quad4>().size());
    std::iota(all.begin(), all.end(), 0);
    sheet.template assign<Costly>(all);
  }
  Adaptation adapt{when<Cheap>(StrainNorm{}).above(leave).template become<Costly>(),
                   when<Costly>(StrainNorm{}).below(come_back).template become<Cheap>(),
                   sleep({.below = at_rest, .for_steps = 32})};
  CentralDifference step;

  Outcome outcome;
  double seconds = 0;
  for (double until : frame_times) {
    auto const begin = std::chrono::steady_clock::now();
    while (sheet.time() < until)
      if (run == Run::adaptive)
        step(sheet, 8, adapt);
      else
        step(sheet, 8);
    backend.synchronize();
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

    outcome.seconds.push_back(seconds);
    outcome.corner.push_back(sheet.displacements()[static_cast<std::size_t>(corner_node(mesh))]);
    auto const asleep = asleep_elements<Quad4>(sheet);
    auto const groups = sheet.template groups_of<Quad4>();
    auto const share = [&](auto const& counts) {
      double count = 0;
      for (std::size_t e = 0; e < groups.size(); ++e) count += counts(e);
      return count / static_cast<double>(groups.size());
    };
    outcome.awake.push_back(share([&](std::size_t e) { return !asleep[e]; }));
    outcome.costly.push_back(share([&](std::size_t e) { return groups[e] == 1; }));
    outcome.drawings.push_back(scene::draw<Quad4>(sheet, "", [&](std::size_t e) {
                                 if (asleep[e]) return picture::pale;
                                 return groups[e] == 1 ? picture::blue : picture::green_to_red(0);
                               }).polygons);
  }
  outcome.steps = sheet.steps();
  return outcome;
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const across = options.cells > 0 ? options.cells : 200;
  auto const mesh = mesh::rectangle({.size = {side, side}, .cells = {across, across}});
  std::printf("Struck corner on %s: 2 m x 2 m, %zu Quad4 elements, E = 2 MPa, nu = 0.3\n",
              TheBackend::name(), mesh.elements<Quad4>().size());
  auto const plain = simulate(backend, mesh, Run::costly);
  auto const adaptive = simulate(backend, mesh, Run::adaptive);

  double largest = 0;
  for (auto const& u : plain.corner) largest = std::max(largest, std::hypot(u[0], u[1]));
  std::vector<picture::Frame> frames;
  std::printf("%8s %9s %12s %8s %12s %14s\n", "time/s", "Ogden/s", "adaptive/s", "awake",
              "under Ogden", "corner's error");
  for (std::size_t k = 0; k < std::size(frame_times); ++k) {
    double const error = std::hypot(plain.corner[k][0] - adaptive.corner[k][0],
                                    plain.corner[k][1] - adaptive.corner[k][1]) /
                         largest;
    std::printf("%8.3f %9.3f %12.3f %7.1f%% %11.1f%% %13.3f%%\n", frame_times[k], plain.seconds[k],
                adaptive.seconds[k], 100 * adaptive.awake[k], 100 * adaptive.costly[k],
                100 * error);
    char caption[96];
    std::snprintf(
        caption, sizeof caption, "(%c) t = %.0f ms: took %.2f s\nall Ogden, awake: %.2f s",
        static_cast<char>('a' + k), 1e3 * frame_times[k], adaptive.seconds[k], plain.seconds[k]);
    frames.push_back({.polygons = adaptive.drawings[k], .caption = caption});
  }
  std::printf("%ld steps of all Ogden, %ld of the adaptive run, in %.2f of the time\n", plain.steps,
              adaptive.steps, adaptive.seconds.back() / plain.seconds.back());

  auto const path = options.output / "struck_corner.png";
  picture::write_strip(path, frames,
                       {.title = "A sheet is struck at a corner; what is at rest sleeps",
                        .columns = 3,
                        .legend = {{"asleep", picture::pale},
                                   {"Saint Venant–Kirchhoff", picture::green_to_red(0)},
                                   {"Ogden", picture::blue}},
                        .length_unit = "m"});
  std::printf("picture: %s\n", path.string().c_str());
}

}  // namespace struck_corner

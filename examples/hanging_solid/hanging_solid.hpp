#pragma once

#include <chrono>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "picture/film.hpp"
#include "scene/levels.hpp"
#include "scene/options.hpp"
#include "scene/solid_drawing.hpp"

// A solid beam of tetrahedra hangs from its top under its weight. The elements that together have 0.65 of the estimated error's
// energy are divided into eight, and the beam finds its equilibrium anew, round after round.
namespace hanging_solid {

using namespace pliant;

using F = Formulation<Tet4, Gauss<1>, Hooke>;

inline constexpr Elastic rubber{.young = 2e6, .poisson = 0.3, .density = 1e3};  // Pa, -, kg/m³
inline constexpr int rounds = 6;
inline constexpr int drawn_apart = 2;           // rounds
inline constexpr Index most_unknowns = 150000;  // of the uniform meshes

template <class TheBackend>
auto make_body(TheBackend const& backend, int across) {
  auto const mesh =
      mesh::box<Tet4>({.size = {1, 1, 4}, .cells = {across, across, 4 * across}});  // m
  Body body{backend, mesh, rubber, Group<F>{}};
  body.clamp(mesh.boundary("top"));
  body.set_gravity({0, 0, -10});
  return body;
}

/// Coloured by level.
template <class TheBody>
picture::Frame draw(TheBody const& body) {
  std::vector<Facet<3>> skin;
  for (auto const& [name, facets] : body.mesh().boundaries)
    skin.insert(skin.end(), facets.begin(), facets.end());
  auto const level = refinement_levels<Tet4>(body);
  return scene::draw_solid<Tet4>(body, skin, 1, [&](std::size_t e) {
    return picture::green_to_red(double(level[e]) / rounds);
  });
}

inline void check(bool holds, char const* what) {
  if (!holds) throw Error("hanging solid: ", what);
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const across = options.cells > 0 ? options.cells : 2;
  auto seconds = [begin = std::chrono::steady_clock::now()]() mutable {
    auto const now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(begin, now)).count();
  };
  std::printf("Hanging solid on %s: 1 m x 1 m x 4 m of Tet4, fixed on top\n", TheBackend::name());
  auto const uniform = scene::refine_uniformly<Tet4>(make_body(backend, across), most_unknowns);
  double const exact = scene::converged(uniform);
  std::printf("uniform refinement: ");
  for (auto const& level : uniform)
    std::printf("%d unknowns %.2f%%, ", level.unknowns,
                100 * std::sqrt((exact - level.energy) / exact));
  std::printf("%.2f s; strain energy extrapolated to %.3f J\n\n", seconds(), exact);

  Adaptation adapt{when<F>(RecoveredStress{}).bulk(0.65).refine()};
  auto body = make_body(backend, across);
  picture::Options look{.title = "A solid beam hangs, and refines where its error is (tetrahedra)",
                        .columns = (rounds + drawn_apart) / drawn_apart,
                        .colour_bar = {.label = "level", .lowest = 0, .highest = rounds},
                        .length_unit = "m"};
  std::vector<picture::Frame> film, strip;
  std::printf("%5s %9s %9s %10s %14s %8s\n", "round", "elements", "unknowns", "error", "uniform's",
              "s");
  double error = 0, other = 0, all_seconds = 0;
  for (int round = 0; round <= rounds; ++round) {
    (void)seconds();
    if (round > 0) adapt.now(body);
    auto const level = scene::solve<Tet4>(body);
    double const own_seconds = seconds();
    all_seconds += own_seconds;
    error = std::sqrt((exact - level.energy) / exact);
    other = std::sqrt(scene::uniform_error(uniform, exact, level.unknowns) / exact);
    std::printf("%5d %9zu %9d %9.2f%% %13.2f%% %8.3f\n", round, level.elements, level.unknowns,
                100 * error, 100 * other, own_seconds);
    std::fflush(stdout);
    auto frame = draw(body);
    char caption[128];
    std::snprintf(caption, sizeof caption, "%zu elements, error %.1f %%", level.elements,
                  100 * error);
    frame.caption = caption;
    if (round % drawn_apart == 0) strip.push_back(frame);
    film.push_back(std::move(frame));
  }
  std::printf("all rounds: %.2f s\n", all_seconds);
  auto const path = options.output / "hanging_solid.png";
  picture::write_strip(path, strip, look);
  std::printf("picture: %s\n", path.string().c_str());
  picture::write_film(options.output / "film", film, look);
  // Of the scene's own cells.
  if (options.cells == 0)
    check(error < 0.75 * other,
          "the error is not below 0.75 of that of uniform meshes with as many unknowns");
}

}  // namespace hanging_solid

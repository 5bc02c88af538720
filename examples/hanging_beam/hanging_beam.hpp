#pragma once

#include <cstdio>

#include <pliant/pliant.hpp>

#include "scene/drawing.hpp"
#include "scene/levels.hpp"
#include "scene/options.hpp"

// Fig. 3 of Caillaud et al. 2013: a beam hangs from its top; the elements that pull hardest at their
// nodes are refined, eight times, and the beam finds its equilibrium anew after each.
namespace hanging_beam {

using namespace pliant;

using Linear = Formulation<Tri3, Gauss<1>, Hooke>;

inline constexpr Elastic rubber{.young = 2e6, .poisson = 0.3, .density = 1e3};  // Pa, -, kg/m³
inline constexpr int refinements = 8;

template <class TheBackend>
auto make_body(TheBackend const& backend, int across) {
  auto const mesh = mesh::rectangle<Tri3>({.size = {1, 4}, .cells = {across, 4 * across}});  // m
  Body body{backend, mesh, rubber, Group<Linear>{}};
  body.clamp(mesh.boundary("top"));
  body.set_gravity({0, -10});
  return body;
}

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const across = options.cells > 0 ? options.cells : 3;
  std::printf("Hanging beam on %s: 1 m x 4 m, fixed on top, refining above 90%% of max(R_S)\n",
              TheBackend::name());
  auto const uniform_levels = scene::refine_uniformly<Tri3>(make_body(backend, across), 60000);
  double const exact = scene::converged(uniform_levels);
  std::printf("uniform refinement: ");
  for (auto const& level : uniform_levels) std::printf("%d ", level.unknowns);
  std::printf("unknowns; strain energy extrapolated to %.5f J\n\n", exact);

  Adaptation adapt{
      when<Linear>(ForceIntensity<>{}).above_fraction_of_largest(0.9).refine({.max_level = 12})};
  auto body = make_body(backend, across);
  std::vector<picture::Frame> frames;
  auto level = scene::solve<Tri3>(body);
  std::printf("%4s %9s %9s %13s %12s %14s %6s\n", "", "elements", "unknowns", "energy/J", "error/J",
              "uniform's/J", "ratio");
  for (int k = 0; k <= refinements; ++k) {
    if (k > 0) {
      adapt.now(body);
      level = scene::solve<Tri3>(body);
      auto const intensity = evaluate<Tri3>(body, ForceIntensity<>{});
      double const strongest = *std::ranges::max_element(intensity);
      char caption[64];
      std::snprintf(caption, sizeof caption, "(%c) %zu elements", 'a' + k - 1, level.elements);
      frames.push_back(scene::draw<Tri3>(body, caption, [&](std::size_t e) {
        return picture::green_to_red(intensity[e] / strongest);
      }));
    }
    double const error = exact - level.energy;
    double const other = scene::uniform_error(uniform_levels, exact, level.unknowns);
    std::printf("%4s %9zu %9d %13.6f %12.6f %14.6f %6.3f\n",
                k == 0 ? "" : std::string{static_cast<char>('a' + k - 1)}.c_str(), level.elements,
                level.unknowns, level.energy, error, other, error / other);
    std::fflush(stdout);
  }
  for (auto const& entry : ledger(body))
    std::printf("ledger: %s: %.0f elements, strain energy %+.3g J\n", entry.action.c_str(),
                entry.elements, entry.strain_energy);

  auto const path = options.output / "hanging_beam.png";
  picture::write_strip(path, frames,
                       {.title = "A hanging beam refines where it is stressed (triangles)",
                        .columns = refinements,
                        .colour_bar = {"R_S / max(R_S)"},
                        .length_unit = "m"});
  std::printf("picture: %s\n", path.string().c_str());
}

}  // namespace hanging_beam

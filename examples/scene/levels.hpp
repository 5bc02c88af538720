#pragma once

#include <cmath>
#include <numeric>
#include <vector>

#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>

// Sequences of meshes at rest under loads, and how far their energies are from that of refinement for ever.
namespace scene {

/// One mesh of a sequence and the energy that it finds.
struct Level {
  pliant::Index unknowns;
  std::size_t elements;
  double energy;  // strain energy at equilibrium, J
};

template <pliant::Element E, class TheBody>
Level solve(TheBody& body) {
  auto const report = pliant::solve_static(body);
  return {report.unknowns, body.mesh().template elements<E>().size(), report.energy};
}

/// Uniform refinement of a body, until the mesh has at least so many unknowns.
template <pliant::Element E, class TheBody>
std::vector<Level> refine_uniformly(TheBody body, pliant::Index unknowns) {
  std::vector<Level> levels{solve<E>(body)};
  while (levels.back().unknowns < unknowns) {
    std::vector<pliant::Index> all(levels.back().elements);
    std::iota(all.begin(), all.end(), 0);
    refine(body, {all});
    levels.push_back(solve<E>(body));
  }
  return levels;
}

/// The energy that refinement for ever would find: Aitken's extrapolation of the three finest uniform
/// meshes, whose errors fall by a constant ratio (a corner singularity governs them).
inline double converged(std::vector<Level> const& levels) {
  auto const n = levels.size();
  double const a = levels[n - 3].energy, b = levels[n - 2].energy, c = levels[n - 1].energy;
  return c + (c - b) * (c - b) / ((b - a) - (c - b));
}

/// The error that uniform refinement would have with so many unknowns: a power law between the
/// meshes around.
inline double uniform_error(std::vector<Level> const& levels, double exact,
                            pliant::Index unknowns) {
  std::size_t k = 1;
  while (k + 1 < levels.size() && levels[k].unknowns < unknowns) ++k;
  double const x0 = std::log(levels[k - 1].unknowns), x1 = std::log(levels[k].unknowns);
  double const y0 = std::log(exact - levels[k - 1].energy), y1 = std::log(exact - levels[k].energy);
  return std::exp(y0 + (y1 - y0) * (std::log(unknowns) - x0) / (x1 - x0));
}

}  // namespace scene

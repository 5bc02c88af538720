#pragma once

#include "work_precision/statics.hpp"

// Errors told by the strain energy, beside that of graded meshes.
namespace pliant::bench {

/// J: the strain energy that Problem::graded(n), which is finer towards the singular places, has at rest.
template <class Problem>
double energy_of_graded(int n) {
  return [n]<Element E>(Mesh<E> const& mesh) {
    Body body{backend<double>(1), mesh, Problem::material(),
              Group<Formulation<E, Full<E>, Problem::template law>>{}};
    Problem::hold(body);
    Problem::load(body);
    return solve_static(body).energy;
  }(Problem::graded(n));
}
/// Sets Problem::reference. What it still lacks goes to stderr, as the error of half as many cells.
template <class Problem>
void find_reference() {
  Problem::reference = energy_of_graded<Problem>(64);
  std::fprintf(stderr, "%s: reference energy %.12g J, relative error of half as many cells %.1e\n",
               Problem::name, Problem::reference,
               1 - energy_of_graded<Problem>(32) / Problem::reference);
}
/// Prints what Problem::reference was extrapolated from.
template <class Problem>
void print_energies(std::vector<int> const& sizes) {
  for (int n : sizes)
    std::printf("%s, graded, n = %d: %.10g J\n", Problem::name, n, energy_of_graded<Problem>(n));
}
/// Of the least potential energy what the strain energy is off by that of the solution is the error's: it lacks it under loads,
/// where the law is linear, and has it too much where nodes are driven.
inline double error_of(double energy, double reference) {
  return std::sqrt(std::abs(reference - energy) / reference);
}

}  // namespace pliant::bench

#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

class Hierarchy;

/// What adaptation did to a body's energy. Switching laws and refining are not physics: whatever
/// they add or take is written down.
template <std::size_t Dim>
struct LedgerEntry {
  double time;  // s; of the last action that it counts
  std::string action;
  double elements;                  // that acted
  double strain_energy;             // change, J
  double kinetic_energy;            // change, J
  std::array<double, Dim> impulse;  // given to held nodes, N s
};

/// The largest mesh that refinement may make.
struct Capacity {
  std::size_t nodes = std::numeric_limits<Index>::max();
  std::size_t elements = std::numeric_limits<Index>::max();
};

/// What a body remembers of its adaptation beyond the present mesh.
template <std::size_t Dim>
struct History {
  /// Per element type, in the order of the mesh: sums of the layouts that are gone.
  struct Totals {
    std::vector<double> counters;  // CounterLayout
  };

  std::shared_ptr<Hierarchy const> tree;  // null before the first refinement
  Capacity capacity;
  std::vector<LedgerEntry<Dim>> refinements;
  std::vector<Totals> totals;
  long born = 0;  // the step at which the present layout was made
};

}  // namespace pliant

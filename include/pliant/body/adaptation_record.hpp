#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <pliant/body/ledger_entries.hpp>
#include <pliant/config.hpp>

namespace pliant {

/// The largest mesh that refinement may make.
struct MeshLimits {
  std::size_t nodes = std::numeric_limits<Index>::max();
  std::size_t elements = std::numeric_limits<Index>::max();
};

/// When an Adaptation last looked at a body.
struct LastLook {
  std::uint64_t adaptation;  // which: see Adaptation
  std::int64_t step;
  /// Of a budget in milliseconds: what the force of one element in the costliest group takes with all that comes with
  /// it, s (0: not known yet), and the step from which on that is measured next; −1: none.
  double seconds_per_evaluation = 0;
  std::int64_t timed = -1;

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("adaptation", r.adaptation...);
    visit("step", r.step...);
    visit("seconds per evaluation", r.seconds_per_evaluation...);
    visit("step of the last measurement", r.timed...);
  }
};

/// What adaptation has done to a body beyond the present mesh.
template <std::size_t Dim>
struct AdaptationRecord {
  LedgerEntries<Dim> refinements;
  /// Per element type, in the order of the mesh: counters (CounterLayout) of the meshes that are gone.
  std::vector<std::vector<double>> totals;
  std::int64_t born = 0;  // the step at which the present mesh was made
  std::vector<LastLook> looks;

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("refinements", r.refinements...);
    visit("totals of earlier meshes", r.totals...);
    visit("birth of the mesh", r.born...);
    visit("looks of adaptations", r.looks...);
  }
};

}  // namespace pliant

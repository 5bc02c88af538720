#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/host_recording.hpp>

namespace pliant {

/// The level of a local time step: one of level l is 2^l times shorter than one of level 0.
using StepLevel = std::uint8_t;
/// A sum of 2^(8 level) over the elements around a node tells the highest level in single precision too.
inline constexpr int most_step_levels = 12;

namespace detail {
/// Whether one loop takes the elements of a table of several levels, each with its own weight: where launches cost, and no
/// law sees its step.
template <Backend B, class Table>
inline constexpr bool takes_levels_at_once = !std::same_as<typename B::Recording, HostRecording> &&
                                             Table::Laws::internal_variable_count == 0;
}  // namespace detail

/// Who acts when in a macro step with local time steps. It follows from the levels of elements in the state;
/// numbers of patches and nodes are internal.
template <Backend B>
struct StepSchedule {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

  int finest = 0;      // the highest level at which something steps
  int term_level = 0;  // at which added force terms act
  std::vector<std::vector<StepLevel>>
      patch_levels;  // (types, patches): of the finest element in it
  /// (types, levels): lists for over(), of the patches of each level; where no law sees its step, of a level and all higher
  /// ones, which one loop takes then.
  std::vector<std::vector<Array<Index>>> patches;
  std::vector<Array<T>> weights;   // (types, elements): of the finest steps in that of an element
  Array<Index> nodes;              // by rate, finest first
  Array<StepLevel> rates;          // of these: the level at which a node moves
  std::vector<Index> node_counts;  // (levels): nodes of this rate or a higher one
  std::vector<Array<Tag>> tags;    // (types, elements): the groups for which the levels were chosen
  double evaluations = 1;          // of elements, over those of as many steps of the finest level

  struct Recorded {
    typename B::Recording recording;
    double step;  // s
    long revision;
  };
  std::optional<Recorded> recorded;  // the events inside a macro step
};

}  // namespace pliant

#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/copy_values.hpp>
#include <pliant/solver/step_levels.hpp>

// From the levels at which elements are stable to who acts when.
namespace pliant {

namespace detail {

/// Which nodes added force terms act on; empty without terms.
template <class Parts>
auto nodes_of_terms(Parts const& parts) {
  constexpr int dim = Parts::dim;
  typename Parts::template Array<StepLevel> none;
  if (parts.pressures.empty() && parts.terms.empty()) return none;
  auto const at_rest = [](Index) { return Point<dim>{}; };
  std::vector<Point<dim>> places(static_cast<std::size_t>(parts.layout.rows));
  auto const& mesh = parts.state.topology->mesh();
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    places[static_cast<std::size_t>(parts.layout.internal_of(static_cast<Index>(i)))] =
        mesh.nodes[i];
  std::vector<StepLevel> touched(places.size(), 0);
  for_each_added_term(parts, [&](auto const& term) {
    term.for_each_element([&](Index i) { return places[static_cast<std::size_t>(i)]; }, at_rest,
                          false,
                          [&](ElementMatrix const& element) {
                            for (Index i : element.nodes) touched[static_cast<std::size_t>(i)] = 1;
                          });
  });
  return upload(parts.backend, touched);
}

/// Makes the levels of nodes from those of elements: the highest around each, through slaves too.
template <class Parts>
void spread_to_nodes(Parts& parts, NodeField<typename Parts::T, 1> field) {
  using T = typename Parts::T;
  clear_rows(parts, {field.data});
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0) return;
    parts.backend.template accumulate<Table::groups>(
        table.elements, SpreadWeight<T>{{table.scratch.data(), table.count()}}, field,
        parts.rest());
  });
}

/// Lists of the patches of each level, for over(), or of each level and all higher ones.
template <Backend B>
auto patches_by_level(B const& backend, std::vector<StepLevel> const& levels, int finest,
                      bool with_higher) {
  std::vector<typename B::template Array<Index>> lists;
  for (int l = 0; l <= finest; ++l) {
    std::vector<Index> list{0};
    for (std::size_t p = 0; p < levels.size(); ++p)
      if (levels[p] == l || (with_higher && levels[p] > l)) list.push_back(static_cast<Index>(p));
    list[0] = static_cast<Index>(list.size()) - 1;
    lists.push_back(upload(backend, list));
  }
  return lists;
}

/// Nodes by the rate at which they move, for a histogram, and those of one rate.
struct BinOfRate {
  StepLevel const* rates;
  PLIANT_HOST_DEVICE Bin operator()(Index i) const { return {rates[i], 1}; }
};
struct IsOfRate {
  StepLevel const* rates;
  StepLevel rate;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return rates[i] == rate; }
};

/// Sorts nodes by the rate at which they move, finest first. `rates`: of each, in the backend's memory.
template <Backend B>
void sort_nodes(B const& backend, Index nodes, StepLevel const* rates, StepSchedule<B>& schedule) {
  auto bins = zeros<std::int64_t>(backend, std::size_t{histogram_bins});
  backend.histogram(nodes, BinOfRate{rates}, bins.data());
  auto const counts = download<std::int64_t>(bins);
  schedule.nodes = unset<Index>(backend, static_cast<std::size_t>(nodes));
  schedule.rates = unset<StepLevel>(backend, static_cast<std::size_t>(nodes));
  schedule.node_counts.assign(static_cast<std::size_t>(schedule.finest) + 1, 0);
  auto how_many = unset<Index>(backend, 1);
  Index before = 0;
  for (int rate = schedule.finest; rate >= 0; --rate) {
    auto const own = static_cast<std::size_t>(rate);
    if (counts[own] > 0)
      backend.select(nodes, IsOfRate{rates, static_cast<StepLevel>(rate)},
                     schedule.nodes.data() + before, how_many.data());
    before += static_cast<Index>(counts[own]);
    schedule.node_counts[own] = before;
  }
  backend.for_each(nodes,
                   TakeListed<StepLevel>{rates, schedule.nodes.data(), schedule.rates.data()});
}

}  // namespace detail

/// Makes parts.schedule from the levels of elements in the state. Twice, an element takes the highest level of
/// those that it shares a node with, slaves standing for their masters: with fewer rings around fine
/// elements some graded meshes are unstable. Then a patch takes the level of its finest element. A node
/// moves at the highest level of what reads it. Added force terms act at the highest level of the elements
/// that stand at their nodes. One that is right already stays. Lists of patches are made on the
/// host.
template <class Parts>
void make_schedule(Parts& parts) {
  using T = typename Parts::T;
  using B = typename Parts::backend_type;
  auto const& backend = parts.backend;
  auto const& interpolation = parts.layout.interpolation;
  auto const field = detail::node_scratch(parts);
  auto const touched = detail::nodes_of_terms(parts);
  StepLevel const* const at_terms = touched.size() > 0 ? touched.data() : nullptr;
  StepSchedule<B> schedule;

  parts.for_each_type([&](auto& table, auto& elements) {
    if (table.count() == 0) return;
    if (table.scratch.size() == 0)
      table.scratch = zeros<T>(backend, static_cast<std::size_t>(table.count()));
    backend.for_each(table.count(),
                     detail::LevelsToWeights<T>{elements.step_levels.data(), table.scratch.data()});
  });
  for (int ring = 0; ring < 2; ++ring) {
    detail::spread_to_nodes(parts, field);
    if (ring == 0 && at_terms)
      schedule.term_level = static_cast<int>(
          backend.maximum(parts.layout.rows, detail::TouchedLevel<T>{field, at_terms}));
    backend.for_each(parts.layout.rows,
                     detail::SumsToLevels<T>{field, at_terms, schedule.term_level});
    interpolation.raise_masters(backend, field);
    interpolation.raise_slaves(backend, field);
    parts.for_each_type([&](auto& table, auto&) {
      using Table = std::remove_cvref_t<decltype(table)>;
      if (table.count() == 0) return;
      backend.template visit<Table::groups>(table.elements,
                                            detail::TakeHighest<T>{table.scratch.data()},
                                            parts.no_counters, NodeField<T const, 1>{field.data});
    });
  }
  double work = 0, elements = 0;
  parts.for_each_type([&](auto& table, auto& of_type) {
    auto levels = unset<StepLevel>(backend, static_cast<std::size_t>(table.elements.patch_count()));
    backend.for_each(
        table.elements.patch_count(),
        detail::RaisePatch<T>{table.scratch.data(), levels.data(), table.elements.patches()});
    schedule.patch_levels.push_back(download<StepLevel>(levels));
    auto const bounds = table.elements.patch_bounds();
    for (std::size_t p = 0; p < schedule.patch_levels.back().size(); ++p) {
      int const level = schedule.patch_levels.back()[p];
      double const size = bounds[p + 1] - bounds[p];
      schedule.finest = std::max(schedule.finest, level);
      work += size * std::exp2(level);
      elements += size;
    }
    schedule.tags.push_back(unset<Tag>(backend, of_type.tags.size()));
    backend.for_each(table.count(),
                     detail::CopyValue<Tag>{of_type.tags.data(), schedule.tags.back().data()});
  });
  if (parts.schedule && parts.schedule->patch_levels == schedule.patch_levels &&
      parts.schedule->term_level == schedule.term_level) {
    parts.schedule->tags = std::move(schedule.tags);
    return;
  }
  schedule.evaluations = elements > 0 ? work / (elements * std::exp2(schedule.finest)) : 1;

  detail::spread_to_nodes(parts, field);
  backend.for_each(parts.layout.rows,
                   detail::SumsToLevels<T>{field, at_terms, schedule.term_level});
  interpolation.raise_masters(backend, field);
  auto rates = unset<StepLevel>(backend, static_cast<std::size_t>(parts.layout.rows));
  backend.for_each(parts.layout.rows, detail::TakeLevel<T>{field, rates.data()});
  detail::sort_nodes(backend, parts.layout.rows, std::as_const(rates).data(), schedule);
  parts.for_each_type([&](auto& table, auto&) {
    constexpr bool at_once = detail::takes_levels_at_once<B, std::remove_cvref_t<decltype(table)>>;
    auto const& levels = schedule.patch_levels[schedule.patches.size()];
    schedule.patches.push_back(detail::patches_by_level(backend, levels, schedule.finest, at_once));
    auto& weights = schedule.weights.emplace_back();
    if (!at_once) return;
    weights = unset<T>(backend, static_cast<std::size_t>(table.count()));
    backend.for_each(table.count(), detail::LevelsToShares<T>{table.scratch.data(), schedule.finest,
                                                              weights.data()});
  });
  parts.schedule = std::move(schedule);
}

/// Whether elements have changed groups since the schedule was made: their levels may be wrong.
template <class Parts>
bool groups_changed(Parts& parts) {
  bool changed = false;
  std::size_t type = 0;
  parts.for_each_type([&](auto& table, auto& elements) {
    using Table = std::remove_cvref_t<decltype(table)>;
    auto const& tags = parts.schedule->tags[type++];
    if constexpr (Table::groups > 1)
      changed =
          changed || parts.backend.sum(table.count(),
                                       detail::DifferentTag{elements.tags.data(), tags.data()}) > 0;
  });
  return changed;
}

}  // namespace pliant

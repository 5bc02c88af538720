#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/adaptation/cells_to_change.hpp>
#include <pliant/adaptation/changes_there.hpp>
#include <pliant/adaptation/commit.hpp>
#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/body/changed_parts_on.hpp>
#include <pliant/body/converted_parts_on.hpp>

// Changes of a body's mesh that are made in its backend's memory.
namespace pliant::detail {

/// What became of a change.
template <class M, Backend B>
struct ChangeOn {
  typename TopologyPlan<M>::Counts counts{};
  std::size_t new_nodes = 0, gone_nodes = 0;
  ToTell<M, B> to_tell{};  // listeners, who do not know yet
};

/// Changes of a body's mesh in its backend's memory: elements are merged, lowered, refined and raised, in this order. What goes wrong
/// leaves the body as it was, but for what was done before where memory runs out; what was kept of the mesh there is made anew then
/// when it is needed.
template <class Parts>
class ChangesOnBackend {
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using On = TopologyOn<M, B>;
  using Done = ChangeOn<M, B>;
  using Cells = typename B::template Array<Index>;
  using Marked = MarkedThere<B>;
  using Lists = std::vector<typename Marked::List>;

 public:
  ChangesOnBackend(Parts& parts, int max_level)
      : parts_(parts),
        limits_{parts.limits.nodes, parts.limits.elements, max_level},
        there_(parts) {}

  /// Elements by the user's numbers. Nothing where the host has to do it.
  std::optional<Done> operator()(Marked const& marked) {
    check_nobody_is_told(std::as_const(parts_), "change of the mesh");
    if (marked.converts() && !can_convert(marked)) return std::nullopt;
    if (!parts_.topology_on && !parts_.state.topology->tree && Marked::none_in(marked.refine) &&
        !marked.converts())
      return Done{};  // nothing to merge
    if (!follow_body()) return std::nullopt;
    if (on().is_too_far_ahead()) (void)*parts_.state.topology;
    bool const tells = !parts_.listeners.empty();
    if (!tells)
      if (auto done = make(marked, marked.coarsen)) return done;
    if (marked.converts()) return std::nullopt;
    // The host knows what conditions forbid to merge.
    plan_ = plan_change(std::as_const(parts_), marked.lists(), limits_.max_level);
    if (!plan_) return Done{};
    planned_ = mesh_behind(*plan_, *parts_.state.prescribed);
    auto const merged = merged_by(*plan_);
    auto done = make(marked, Marked::of(backend(), merged));
    if (done && tells) done->to_tell.plan = std::move(plan_);
    return done;
  }

 private:
  /// While it lives, the host takes nothing from what is changed.
  class Changing {
   public:
    explicit Changing(std::shared_ptr<On> on) : on_(std::move(on)) {
      on_->on_host.is_changing = true;
    }
    Changing(Changing const&) = delete;
    Changing& operator=(Changing const&) = delete;
    ~Changing() { on_->on_host.is_changing = false; }

   private:
    std::shared_ptr<On> on_;
  };

  static Index size(auto const& list) { return static_cast<Index>(list.size()); }
  On& on() { return *parts_.topology_on; }
  B const& backend() const { return parts_.backend; }
  Cells cells_of(Lists const& lists) {
    std::size_t count = 0;
    for (auto const& list : lists) count += static_cast<std::size_t>(list.count);
    auto cells = unset<Index>(backend(), count);
    Index* to = cells.data();
    for (std::size_t type = 0; type < lists.size(); to += lists[type++].count)
      backend().for_each(lists[type].count,
                         LookUpCells{on().element_numbers(type), lists[type].numbers.data(), to});
    return cells;
  }

  /// Brings what is kept of the mesh up to the body, where the body has changed otherwise; whether that can be.
  bool follow_body() {
    bool const is_there = parts_.topology_on != nullptr;
    if (is_there && on().is_of_conditions(std::as_const(parts_))) return true;
    HostThreads const threads(backend(), *parts_.state.topology);
    if (!is_there) parts_.topology_on = std::make_shared<On>(std::as_const(parts_));
    return on().follow_conditions(std::as_const(parts_));
  }

  /// The elements of families that a plan merges, by the type.
  static std::vector<std::vector<Index>> merged_by(TopologyPlan<M> const& plan) {
    std::vector<std::vector<Index>> merged(On::types);
    for (auto const& family : plan.transfer.families())
      if (family.after.size() == 1)
        for (auto const& member : family.before) merged[member.type].push_back(member.element);
    return merged;
  }

  /// Whether the backend makes the change where elements get another degree: a listener gets it from the host, or by itself; and no
  /// node may have to stay behind a change that was made.
  [[nodiscard]] bool can_convert(Marked const& marked) const {
    if constexpr (!converts_on_backend<Parts>) return false;
    if (!parts_.listeners.empty()) return false;
    bool const lowers = !Marked::none_in(marked.lower);
    bool const is_one = lowers + !Marked::none_in(marked.refine) +
                            !Marked::none_in(marked.coarsen) + !Marked::none_in(marked.raise) ==
                        1;
    if (is_one) return true;
    auto const names_nodes = [](auto const& condition) { return condition.facets.empty(); };
    return parts_.backend_listeners.empty() &&
           !(lowers && std::ranges::any_of(parts_.state.prescribed->conditions, names_nodes));
  }
  /// Nothing where conditions forbid some of it; then nothing has changed. Merges these in place of those that are marked.
  std::optional<Done> make(Marked const& marked, Lists const& coarsen) {
    Changing const changing(parts_.topology_on);
    try {
      return change(marked, coarsen);
    } catch (...) {
      if (parts_.topology_on) on().tree.take_back();
      if (!merged_.empty() || there_.any()) tell_of_merged();
      throw;
    }
  }
  std::optional<Done> change(Marked const& marked, Lists const& coarsen) {
    Done done;
    auto& counts = done.counts;
    CellsToChange<B> cells{cells_of(marked.refine), cells_of(coarsen), cells_of(marked.lower),
                           cells_of(marked.raise)};
    if (marked.raised_rings > 0 && cells.raise.size() > 0) {
      auto const [n, with_rings] =
          on().tree.with_neighbours(cells.raise.data(), size(cells.raise), marked.raised_rings);
      cells.raise = unset<Index>(backend(), static_cast<std::size_t>(n));
      copy_values<B, Index>(backend(), with_rings, cells.raise.data(), cells.raise.size());
    }
    if (!plan_ && cells.need_trial(limits_))
      cells.leave_what_is_refined(backend(), on().tree, nodes_when_raised<M>(), limits_);
    if (cells.merge.size() > 0) {
      auto const merged = on().tree.coarsen(cells.merge.data(), size(cells.merge));
      if (merged.merged > 0) {
        if (!on().held.coarsen(backend(), on().tree, merged, on().rows.of_node())) {
          on().tree.take_back();
          return std::nullopt;
        }
        counts.coarsened = static_cast<std::size_t>(merged.merged);
        done.gone_nodes = static_cast<std::size_t>(merged.before.nodes - merged.now.nodes);
        cells.renumber(backend(), merged);
        bool const is_all = plan_ && plan_->counts.refined == 0;
        auto parents = plan_ && !is_all ? parents_of(merged) : std::vector<Index>{};
        commit("coarsen", counts.coarsened, merged, is_all,
               [&](auto& parts) { return parts.coarsened(merged); });
        merged_ = std::move(parents);
      }
    }
    if constexpr (converts_on_backend<Parts>)
      if (cells.lower.size() > 0 && !lower(cells.lower, done)) return std::nullopt;
    if (cells.refine.size() > 0) {
      auto const refined = on().tree.refine(cells.refine.data(), size(cells.refine), limits_);
      if (refined.leaves > 0) {
        counts.refined = static_cast<std::size_t>(refined.leaves);
        done.new_nodes = static_cast<std::size_t>(refined.new_nodes);
        commit("refine", counts.refined, refined, plan_.has_value(),
               [&](auto& parts) { return parts.refined(refined); });
        merged_.clear();
      }
    }
    if constexpr (converts_on_backend<Parts>)
      if (cells.raise.size() > 0) raise(cells.raise, done);
    enter_as_one(counts);
    done.to_tell.there = there_.take();
    return done;
  }
  /// False where a node has to stay; then nothing has changed.
  bool lower(Cells const& cells, Done& done) {
    auto const lowered = on().tree.lower(cells.data(), size(cells));
    if (lowered.lowered == 0) return true;
    if (!on().held.coarsen(backend(), on().tree, lowered, on().rows.of_node())) {
      on().tree.take_back();
      return false;
    }
    done.counts.lowered = static_cast<std::size_t>(lowered.lowered);
    done.gone_nodes = static_cast<std::size_t>(lowered.before.nodes - lowered.now.nodes);
    commit("lower", done.counts.lowered, lowered, false,
           [&](auto& parts) { return parts.changed(lowered); });
    return true;
  }
  void raise(Cells const& cells, Done& done) {
    auto const raised = on().tree.raise(cells.data(), size(cells), nodes_when_raised<M>(), limits_);
    if (raised.raised == 0) return;
    done.counts.raised = static_cast<std::size_t>(raised.raised);
    done.new_nodes += static_cast<std::size_t>(raised.new_nodes);
    commit("raise", done.counts.raised, raised, false,
           [&](auto& parts) { return parts.changed(raised); });
  }
  std::vector<Index> parents_of(Coarsened const& merged) const {
    auto const count = static_cast<std::size_t>(merged.merged);
    auto parents = unset<Index>(backend(), count);
    copy_values<B, Index>(backend(), merged.parents, parents.data(), count);
    return download<Index>(parents);
  }
  /// Where what was to be refined beside elements that were merged is not.
  void tell_of_merged() {
    ToTell<M, B> to_tell;
    if (!merged_.empty())
      to_tell.plan = plan_on_host(plan_->before, merged_, ChangeOfCells::merge,
                                  element_values_of(std::as_const(parts_)));
    to_tell.there = there_.take();
    tell_listeners(parts_, to_tell);
  }
  /// Makes a change, `done` on the tree, of `count` elements. `is_planned`: whether the host's mesh behind it is that of the
  /// plan.
  template <class ChangeOfTree, class Change>
  void commit(char const* action, std::size_t count, ChangeOfTree const& done, bool is_planned,
              Change const& make) {
    constexpr bool converts =
        std::same_as<ChangeOfTree, Raised> || std::same_as<ChangeOfTree, Lowered>;
    using Changed = std::conditional_t<converts, ConvertedPartsOn<Parts>, ChangedPartsOn<Parts>>;
    auto const kept = std::exchange(parts_.topology_on, nullptr);  // gone where something throws
    there_.begin(*kept);
    commit_change(parts_, action, count, [&] {
      Changed parts(parts_, kept, is_planned ? planned_ : MeshOnHost<M>{});
      auto changed = make(parts);
      // Patches are there now, beside whose plans this takes longer.
      for (auto& numbers : kept->numbers) numbers.follow(backend(), kept->tree, done);
      there_.follow(*kept, done, changed.parts);
      return changed;
    });
    there_.keep();
    kept->tree.keep();
    ++kept->on_host.version;
    ++kept->on_host.changes;
    kept->on_host.cells += count;
    if (is_planned) kept->set_on_host(planned_);
  }
  /// The entries of the ledger that the change made become one.
  void enter_as_one(typename TopologyPlan<M>::Counts const& counts) {
    int const made =
        (counts.refined > 0) + (counts.coarsened > 0) + (counts.raised > 0) + (counts.lowered > 0);
    if (made < 2) return;
    auto& entries = parts_.state.record.refinements;
    auto entry = entries.take_back();
    for (int k = 1; k < made; ++k) {
      auto const before = entries.take_back();
      entry.elements += before.elements;
      entry.strain_energy += before.strain_energy;
      entry.kinetic_energy += before.kinetic_energy;
      for (std::size_t d = 0; d < entry.impulse.size(); ++d) entry.impulse[d] += before.impulse[d];
    }
    entry.action = actions_of(counts);
    entries.push_back(std::move(entry));
  }

  Parts& parts_;
  RefinementLimits limits_;
  std::optional<TopologyPlan<M>> plan_{};  // where the host has made one
  MeshOnHost<M> planned_{};                // behind it
  std::vector<Index> merged_{};            // cells, while the rest of the plan is not made
  ChangesThere<Parts> there_;              // that are made
};

}  // namespace pliant::detail

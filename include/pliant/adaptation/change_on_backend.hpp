#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/adaptation/changes_there.hpp>
#include <pliant/adaptation/commit.hpp>
#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/body/changed_parts_on.hpp>

// Changes of a body's mesh that are made in its backend's memory.
namespace pliant::detail {

/// What became of a change.
template <class M, Backend B>
struct ChangeOn {
  std::size_t refined = 0, new_nodes = 0, merged = 0, gone_nodes = 0;
  ToTell<M, B> to_tell{};  // listeners, who do not know yet
};

/// Changes of a body's mesh in its backend's memory. What goes wrong leaves the body as it was, but for elements that were merged
/// where memory runs out as others are refined; what was kept of the mesh there is made anew then when it is needed.
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
    if (!parts_.topology_on && Marked::none_in(marked.refine) && !parts_.state.topology->tree)
      return Done{};  // nothing to merge
    if (!follow_body()) return std::nullopt;
    if (on().is_too_far_ahead()) (void)*parts_.state.topology;
    bool const tells = !parts_.listeners.empty();
    if (!tells)
      if (auto done = make(marked.refine, marked.coarsen)) return done;
    // The host knows what conditions forbid to merge.
    plan_ = plan_change(std::as_const(parts_), marked.lists(), limits_.max_level);
    if (!plan_) return Done{};
    planned_ = mesh_behind(*plan_, *parts_.state.prescribed);
    auto const merged = merged_by(*plan_);
    auto done = make(marked.refine, Marked::of(backend(), merged));
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

  /// Nothing where conditions forbid some of it; then nothing has changed.
  std::optional<Done> make(Lists const& refine, Lists const& coarsen) {
    Changing const changing(parts_.topology_on);
    try {
      return change(refine, coarsen);
    } catch (...) {
      if (parts_.topology_on) on().tree.take_back();
      if (!merged_.empty() || there_.any()) tell_of_merged();
      throw;
    }
  }
  std::optional<Done> change(Lists const& refine, Lists const& coarsen) {
    Done done;
    auto to_refine = cells_of(refine), to_merge = cells_of(coarsen);
    if (!plan_ && to_refine.size() > 0 && to_merge.size() > 0)
      leave_what_is_refined(to_refine, to_merge);
    if (to_merge.size() > 0) {
      auto const merged = on().tree.coarsen(to_merge.data(), size(to_merge));
      if (merged.merged > 0) {
        if (!on().held.coarsen(backend(), on().tree, merged, on().rows.of_node())) {
          on().tree.take_back();
          return std::nullopt;
        }
        done.merged = static_cast<std::size_t>(merged.merged);
        done.gone_nodes = static_cast<std::size_t>(merged.before.nodes - merged.now.nodes);
        renumber(to_refine, merged);
        bool const is_all = plan_ && plan_->counts.refined == 0;
        auto parents = plan_ && !is_all ? parents_of(merged) : std::vector<Index>{};
        commit("coarsen", done.merged, merged, is_all,
               [&](auto& parts) { return parts.coarsened(merged); });
        merged_ = std::move(parents);
      }
    }
    if (to_refine.size() > 0) {
      auto const refined = on().tree.refine(to_refine.data(), size(to_refine), limits_);
      if (refined.leaves > 0) {
        done.refined = static_cast<std::size_t>(refined.leaves);
        done.new_nodes = static_cast<std::size_t>(refined.new_nodes);
        commit("refine", done.refined, refined, plan_.has_value(),
               [&](auto& parts) { return parts.refined(refined); });
        merged_.clear();
      }
    }
    if (done.merged > 0 && done.refined > 0) enter_as_one();
    done.to_tell.there = there_.take();
    return done;
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
      to_tell.plan =
          plan_on_host(plan_->before, merged_, true, element_values_of(std::as_const(parts_)));
    to_tell.there = there_.take();
    tell_listeners(parts_, to_tell);
  }
  void renumber(Cells& cells, Coarsened const& merged) {
    backend().for_each(size(cells),
                       RenumberCells{{merged.staying.cells, merged.cells}, cells.data()});
  }

  /// Tries a change on the tree, and takes from the elements to merge those of families that a refinement beside them would
  /// divide again. Throws Error where a limit would be exceeded.
  void leave_what_is_refined(Cells const& refine, Cells& merge) {
    while (merge.size() > 0) {
      auto const merged = on().tree.coarsen(merge.data(), size(merge));
      if (merged.merged == 0) return;
      auto cells = extended(backend(), refine, refine.size());
      renumber(cells, merged);
      auto const refined = on().tree.refine(cells.data(), size(cells), limits_);
      auto const families = static_cast<std::size_t>(merged.merged);
      auto parents = zeros<Index>(backend(), families);
      copy_values<B, Index>(backend(), merged.parents, parents.data(), families);
      auto again = zeros<Index>(backend(), families + 1);  // and whether there are any
      backend().for_each(refined.leaves, FindMergedAgain{refined.cells,
                                                         parents.data(),
                                                         {merged.staying.cells, merged.cells},
                                                         merged.merged,
                                                         again.data()});
      auto any = zeros<Index>(backend(), 1);
      copy_values<B, Index>(backend(), again.data() + families, any.data(), 1);
      bool const some_are = download<Index>(any)[0] != 0;
      on().tree.take_back();
      if (!some_are) return;
      auto left = zeros<Index>(backend(), merge.size());
      auto count = zeros<Index>(backend(), 1);
      backend().select(size(merge),
                       IsMergedForGood{on().tree.view(), merge.data(), parents.data(),
                                       merged.merged, again.data()},
                       left.data(), count.data());
      auto const n = download<Index>(count)[0];
      backend().for_each(n, LookUp{merge.data(), left.data()});
      merge = extended(backend(), left, static_cast<std::size_t>(n));
    }
  }

  /// Makes a change, `done` on the tree, of `count` elements. `is_planned`: whether the host's mesh behind it is that of the
  /// plan.
  template <class Done, class Change>
  void commit(char const* action, std::size_t count, Done const& done, bool is_planned,
              Change const& make) {
    auto const kept = std::exchange(parts_.topology_on, nullptr);  // gone where something throws
    there_.begin(*kept);
    commit_change(parts_, action, count, [&] {
      ChangedPartsOn<Parts> parts(parts_, kept, is_planned ? planned_ : MeshOnHost<M>{});
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
  /// The last two entries of the ledger become one.
  void enter_as_one() {
    auto& entries = parts_.state.record.refinements;
    auto entry = entries.take_back();
    auto const merged = entries.take_back();
    entry.action = "refine and coarsen";
    entry.elements += merged.elements;
    entry.strain_energy += merged.strain_energy;
    entry.kinetic_energy += merged.kinetic_energy;
    for (std::size_t k = 0; k < entry.impulse.size(); ++k) entry.impulse[k] += merged.impulse[k];
    entries.push_back(std::move(entry));
  }

  Parts& parts_;
  RefinementLimits limits_;
  std::optional<TopologyPlan<M>> plan_{};  // where the host has made one
  MeshOnHost<M> planned_{};                // behind it
  std::vector<Index> merged_{};            // cells, while the rest of the plan is not made
  ChangesThere<Parts> there_;              // that are made
};

/// Changes a body's mesh in its backend's memory, where that can be; else nothing. `find_marked`: gives a MarkedThere. Errors as
/// of refine.
template <class Parts, class FindMarked>
auto change_on_backend_by(Parts& parts, int max_level, FindMarked const& find_marked)
    -> std::optional<ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>> {
  using Done = ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>;
  if constexpr (changes_on_backend<Parts>) {
    if (!can_change_on_backend(parts)) return std::nullopt;
    auto const marked = find_marked();
    if (marked.none_in(marked.refine) && marked.none_in(marked.coarsen)) return Done{};
    return ChangesOnBackend<Parts>(parts, max_level)(marked);
  } else {
    return std::nullopt;
  }
}
/// Of elements by the user's numbers, for each type; lists of no types name none.
template <class Parts>
auto change_on_backend(Parts& parts, std::vector<std::vector<Index>> const& refine,
                       std::vector<std::vector<Index>> const& coarsen, int max_level) {
  return change_on_backend_by(parts, max_level, [&] {
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      auto const check = [&](char const* verb, auto const& lists) {
        if (type < lists.size())
          check_numbers<E>(verb, lists[type], static_cast<std::size_t>(table.count()));
      };
      check("refine", refine);
      check("coarsen", coarsen);
      ++type;
    });
    using Marked = MarkedThere<typename Parts::backend_type>;
    return Marked{Marked::of(parts.backend, refine), Marked::of(parts.backend, coarsen)};
  });
}
/// Of those that are marked, where that is all.
template <class Parts>
auto change_on_backend(Parts& parts, MeshMarks const& marks)
    -> std::optional<ChangeOn<typename Parts::mesh_type, typename Parts::backend_type>> {
  if (!marks.only_refine_and_coarsen()) return std::nullopt;
  return change_on_backend_by(parts, marks.max_level,
                              [&] { return marked_there(std::as_const(parts), marks); });
}

}  // namespace pliant::detail

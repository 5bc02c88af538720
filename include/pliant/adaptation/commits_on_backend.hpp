#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/adaptation/changes_there.hpp>
#include <pliant/adaptation/commit.hpp>
#include <pliant/body/changed_parts_on.hpp>
#include <pliant/body/converted_parts_on.hpp>

// How changes of a body's mesh that were made on its tree, in the backend's memory, are put in force.
namespace pliant::detail {

/// Puts changes in force, one after the other, and knows what listeners are to be told.
template <class Parts>
class CommitsOnBackend {
 protected:
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using On = TopologyOn<M, B>;

  explicit CommitsOnBackend(Parts& parts) : parts_(parts), there_(parts) {}

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

  On& on() { return *parts_.topology_on; }
  B const& backend() const { return parts_.backend; }

  /// change(): leaves the tree as it was where it throws.
  template <class Change>
  auto guarded(Change const& change) {
    Changing const changing(parts_.topology_on);
    try {
      return change();
    } catch (...) {
      if (parts_.topology_on) on().tree.take_back();
      if (!merged_.empty() || there_.any()) tell_of_merged();
      throw;
    }
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
      to_tell.plan = plan_on_host(plan_->before, merged_, ChangeOfCells::coarsen,
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
        std::same_as<ChangeOfTree, Raised> || std::same_as<ChangeOfTree, Lowered> ||
        std::same_as<ChangeOfTree, typename TreeOn<B>::Split> || std::same_as<ChangeOfTree, Merged>;
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
    int const made = (counts.refined > 0) + (counts.coarsened > 0) + (counts.raised > 0) +
                     (counts.lowered > 0) + (counts.split > 0) + (counts.merged > 0);
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
  std::optional<TopologyPlan<M>> plan_{};  // where the host has made one
  MeshOnHost<M> planned_{};                // behind it
  std::vector<Index> merged_{};            // cells, while the rest of the plan is not made
  ChangesThere<Parts> there_;              // that are made
};

}  // namespace pliant::detail

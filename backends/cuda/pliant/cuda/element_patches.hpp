#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/patch_cuts.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/element_views.cuh>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_memory.cuh>
#include <pliant/cuda/plan_patches.cuh>
#include <pliant/cuda/tuning.hpp>

namespace pliant {

template <std::floating_point T>
class Cuda;

namespace detail {

/// How the elements of a table are cut into patches, and what is planned for each.
template <std::floating_point T, int Nodes>
class ElementPatches {
  using Planner = PatchPlanner<Nodes>;
  static constexpr int width = ElementView<Nodes>::width;

 public:
  ElementPatches() = default;
  /// Of `count` rows of nodes on the device, which stay there.
  ElementPatches(Index const* rows, Index count) : rows_(rows), count_(count) {}

  Index size() const { return cuts_.size(); }
  Index count() const { return cuts_.count(); }
  PatchRanges ranges() const { return {first_.data(), of_run_.data(), cuts_.size()}; }
  std::span<Index const> bounds() const { return cuts_.first(); }
  int threads() const { return threads_; }
  /// Whether accumulation takes fans of elements, where the kernel allows it.
  bool has_fans() const {
    assert(!unsettled_);
    return fans_.units.size() > 0;
  }
  PatchView<PatchRow<Nodes>> patch_view(Tag const* tags, ActiveList const& active) const {
    return view_of(patches_, tags, active);
  }
  PatchView<FanVisit> fan_view(Tag const* tags, ActiveList const& active) const {
    return view_of(fans_, tags, active);
  }

  /// Plans patches as suits the GPU; in fans where kernels may be given nodes in any even order. `before`: null, or those before a
  /// change to blocks.
  void plan(Cuda<T> const& backend, NodeOrder order, ElementBlocks const& blocks,
            ElementPatches const* before = nullptr) {
    if (plans_fans(order, count_) && plan_fans(backend, fan_size(), blocks, before)) return;
    plan(backend, tuned(count_), blocks, before);
  }
  /// The same beside what is queued on the backend's stream from now on, if it was so before a change; settle waits for it.
  void plan_beside(Cuda<T> const& backend, NodeOrder order, ElementBlocks const& blocks,
                   ElementPatches const& before) {
    bool begun = false;
    if constexpr (Nodes == FanPlanner::nodes)
      if (plans_fans(order, count_))
        begun = begin<FanPlanner>(backend, fan_size(), order, blocks, before);
    if constexpr (!scatters<T, Nodes>)
      if (!begun) begun = begin<Planner>(backend, tuned(count_), order, blocks, before);
    if (!begun) plan(backend, order, blocks, &before);
  }
  void plan(Cuda<T> const& backend, std::array<int, 2> size_and_threads,
            ElementBlocks const& blocks = {}, ElementPatches const* before = nullptr) {
    auto const [size, threads] = size_and_threads;
    threads_ = threads;
    if constexpr (scatters<T, Nodes>) {
      cut(backend, size, blocks);
    } else {
      constexpr int small = patch_tuning<T, Nodes>().small_size;
      if (make<Planner>(backend, size, blocks, before) || size <= small) return;
      threads_ = small;
      (void)make<Planner>(backend, small, blocks, before);
    }
  }
  bool plan_fans(Cuda<T> const& backend, std::array<int, 2> size_and_threads,
                 ElementBlocks const& blocks = {}, ElementPatches const* before = nullptr) {
    if constexpr (Nodes == FanPlanner::nodes) {
      auto const [size, threads] = size_and_threads;
      if (size > FanSplitter::most_elements || !make<FanPlanner>(backend, size, blocks, before))
        return false;
      threads_ = threads;
      return has_fans();
    } else {
      return false;
    }
  }
  /// Waits for patches that are being planned.
  void settle(Cuda<T> const& backend) {
    if (!unsettled_) return;
    auto const own = std::move(unsettled_);
    own->work.stream().wait();
    if (!own->end(*this, *static_cast<PatchCounts const*>(own->work.mail())))
      plan(backend, own->order, own->blocks);
  }

 private:
  /// Patches that are being planned.
  struct Unsettled {
    std::function<bool(ElementPatches&, PatchCounts const&)>
        end;  // takes their plan, with what any needs; whether they fit
    NodeOrder order;
    ElementBlocks blocks;
    SideWork work;  // goes first, and with it ends what uses the rest
  };

  template <class P>
  PatchView<typename P::Unit> view_of(PatchPlan<P> const& plan, Tag const* tags,
                                      ActiveList const& active) const {
    assert(!unsettled_);
    return {cuts_.size(),      first_.data(),     plan.capacity,         tags,
            plan.units.data(), plan.nodes.data(), plan.diagonals.data(), active};
  }
  void cut(Cuda<T> const& backend, int size, ElementBlocks const& blocks) {
    cuts_ = PatchCuts(count_, size, blocks);
    first_ = backend.array(std::span<Index const>(cuts_.first()));
    auto const runs = PatchRanges::runs(count_);
    of_run_ = backend.template unset_array<Index>(static_cast<std::size_t>(runs));
    backend.for_each(runs, PatchOfRun{first_.data(), cuts_.count(), of_run_.data()});
  }

  PatchInput input() const { return {rows_, width, cuts_.size(), first_.data()}; }
  template <class P>
  PatchPlan<P> const& planned_by() const {
    if constexpr (std::same_as<P, FanPlanner>)
      return fans_;
    else
      return patches_;
  }
  template <class P>
  PatchPlan<P>& plan_by() {
    return const_cast<PatchPlan<P>&>(std::as_const(*this).template planned_by<P>());
  }
  /// Whether a GPU has shared memory to plan patches of a size.
  template <class P>
  static bool can_plan(Cuda<T> const& backend, int size) {
    int const most = most_shared_bytes(backend.device());
    return size <= most && plan_bytes<P>(size) <= most;
  }
  /// Whether it has some to work on patches of a capacity, with three fields of three components, and tags.
  template <class P>
  bool accepts(Cuda<T> const& backend, PatchCounts const& capacity) const {
    if constexpr (std::same_as<P, FanPlanner>)
      if (capacity.nodes > FanSplitter::most_nodes) return false;
    return PatchMemory<T, 3, 9>::bytes(capacity) + cuts_.size() <=
           most_shared_bytes(backend.device());
  }
  /// What P planned before a change to blocks, if patches had the same size.
  template <class P>
  KnownPatches<P> known_patches(ElementPatches const* before, ElementBlocks const& blocks) const {
    if (before == nullptr || before->size() != cuts_.size()) return {};
    auto const& plan = before->template planned_by<P>();
    if (plan.units.size() == 0) return {};
    return {&plan, before->first_.data(), cuts_.known_from(before->cuts_, blocks)};
  }

  /// Plans patches of a size by P; whether they fit the GPU's shared memory. `before`: null, or a table before a change to blocks.
  template <class P>
  bool make(Cuda<T> const& backend, int size, ElementBlocks const& blocks,
            ElementPatches const* before) {
    if (!can_plan<P>(backend, size)) return false;
    cut(backend, size, blocks);
    bool fits = true;
    plan_by<P>() =
        plan_patches<P>(backend, input(), cuts_, known_patches<P>(before, blocks),
                        [&](auto const& capacity) { return fits = accepts<P>(backend, capacity); });
    return fits;
  }
  /// Begins to do so on a side stream, where P did so before.
  template <class P>
  bool begin(Cuda<T> const& backend, std::array<int, 2> size_and_threads, NodeOrder order,
             ElementBlocks const& blocks, ElementPatches const& before) {
    auto const [size, threads] = size_and_threads;
    if (!can_plan<P>(backend, size)) return false;
    cut(backend, size, blocks);
    auto const known = known_patches<P>(&before, blocks);
    if (known.plan == nullptr || cuts_.count() == 0) return false;
    threads_ = threads;
    SideWork side(backend.side_stream());
    auto const work =
        std::make_shared<PlanInWork<P>>(begin_plan(backend, input(), cuts_, known, &side));
    auto const end = [=](ElementPatches& own, PatchCounts const& counts) {
      bool fits = true;
      own.template plan_by<P>() =
          end_plan(backend, std::move(*work), counts, own.cuts_,
                   [&](auto const& capacity) { return fits = own.accepts<P>(backend, capacity); });
      return fits;
    };
    unsettled_.reset(new Unsettled{end, order, blocks, std::move(side)});
    return true;
  }

  static bool plans_fans(NodeOrder order, Index count) {
    return Nodes == FanPlanner::nodes && order == NodeOrder::any_even &&
           count >= fan_tuning<T>().least_elements;
  }
  static constexpr std::array<int, 2> fan_size() {
    constexpr auto t = fan_tuning<T>();
    return {t.patch_size, t.threads};
  }
  static std::array<int, 2> tuned(Index count) {
    constexpr auto t = patch_tuning<T, Nodes>();
    if (count < t.large_from) return {t.small_size, t.small_size};
    return {t.patch_size, t.threads};
  }

  Index const* rows_ = nullptr;
  Index count_ = 0;
  int threads_ = 1;
  PatchCuts cuts_;
  DeviceArray<Index> first_, of_run_;  // see PatchRanges
  PatchPlan<Planner> patches_;
  PatchPlan<FanPlanner> fans_;            // in place of the others
  std::unique_ptr<Unsettled> unsettled_;  // goes first
};

}  // namespace detail
}  // namespace pliant

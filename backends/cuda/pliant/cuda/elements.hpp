#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/patch_cuts.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/nodes_of_patch.cuh>
#include <pliant/cuda/plan_patches.cuh>
#include <pliant/cuda/tuning.hpp>

namespace pliant {

template <std::floating_point T>
class Cuda;

namespace detail {

/// Which patches of a table a kernel looks at.
struct ActiveList {
  Index const* list = nullptr;  // how many, then their numbers; null: all
  Index most = 0;               // how many the list has room for

  /// The patch of number k among these; negative behind the last one.
  __device__ __forceinline__ Index patch(Index k) const {
    if (list == nullptr) return k;
    return k < most && k < list[0] ? list[k + 1] : -1;
  }
};

/// An element table as kernels see it.
template <int Nodes>
struct ElementView {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  Index count;
  Index const* connectivity;  // (elements, width)
  Tag const* tags;
  int patch_size;      // elements, at most
  Index const* first;  // (patches + 1), elements
  ActiveList active;

  /// The i-th element of the active patches; negative where the last patch has none.
  __device__ __forceinline__ Index element(Index i) const {
    Index end = count;
    if (active.list != nullptr) {
      Index const patch = active.patch(i / patch_size);
      if (patch < 0) return -1;
      i = first[patch] + i % patch_size;
      end = first[patch + 1];
    }
    return i < end ? i : -1;
  }
};

/// The patches of an element table as kernels see them.
template <class Unit>
struct PatchView {
  int patch_size;      // elements, at most
  Index const* first;  // (patches + 1), elements
  PatchCounts capacity;
  Tag const* tags;
  Unit const* units;               // PatchRow (elements), or FanVisit (patches, visits, fans)
  PatchNode const* nodes;          // (patches, node capacity)
  std::uint16_t const* diagonals;  // (patches, diagonal capacity)
  ActiveList active;

  __device__ __forceinline__ NodesOfPatch nodes_of(Index patch) const {
    return {nodes + static_cast<std::ptrdiff_t>(patch) * capacity.nodes, capacity.nodes};
  }
  __device__ __forceinline__ void load_diagonals(Index patch, std::uint16_t* to) const {
#pragma unroll 1
    for (int d = static_cast<int>(threadIdx.x); d < capacity.diagonals;
         d += static_cast<int>(blockDim.x))
      to[d] = diagonals[static_cast<std::ptrdiff_t>(patch) * capacity.diagonals + d];
  }
};

}  // namespace detail

/// Connectivity, tags and patches on the device.
template <std::floating_point T, int Nodes>
class CudaElements {
  using View = detail::ElementView<Nodes>;

 public:
  static constexpr int nodes_per_element = Nodes, row_width = View::width;
  CudaElements() = default;
  /// Simplices of four nodes are loaded in fans where they are many, if kernels may be given their nodes in any even
  /// order.
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               int /* groups */, std::vector<Tag> const& tags, Index nodes,
               NodeOrder order = NodeOrder::as_given, ElementBlocks const& blocks = {},
               CudaElements const* before = nullptr)
      : CudaElements(backend, connectivity, tags, nodes, blocks, before) {
    plan(backend, order, blocks, before);
  }
  /// The same of rows that are on the device, whose numbers of nodes are not looked at: see TakesRows.
  CudaElements(Cuda<T> const& backend, DeviceArray<Index> rows, int /* groups */,
               DeviceArray<Tag> tags, Index /* nodes */, NodeOrder order = NodeOrder::as_given,
               ElementBlocks const& blocks = {}, CudaElements const* before = nullptr)
      : count_(blocks.count(rows.size() / row_width)),
        tags_(std::move(tags)),
        connectivity_(std::move(rows)) {
    if (tags_.size() == 0) tags_ = backend.template array<Tag>(static_cast<std::size_t>(count_));
    tag_data_ = tags_.data();
    plan(backend, order, blocks, before);
  }
  /// With patches of a given size and threads per block, for tuning; small ones where the GPU has no room in
  /// shared memory for those. Throws Error when the size is no multiple of the threads.
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               std::vector<Tag> const& tags, Index nodes, std::array<int, 2> size_and_threads,
               NodeOrder order = NodeOrder::as_given)
      : CudaElements(backend, connectivity, tags, nodes) {
    auto const [size, threads] = size_and_threads;
    if (threads < 1 || size < threads || size % threads != 0)
      throw Error("patches of ", size, " elements for ", threads,
                  " threads; give a multiple of the threads");
    if (order == NodeOrder::any_even && plan_fans(backend, size_and_threads)) return;
    plan(backend, size_and_threads);
  }

  Index count() const { return count_; }
  ElementRows rows_of_nodes() const { return {connectivity_.data(), View::width}; }
  Index scratch_nodes() const { return 0; }
  DeviceArray<Tag>& tags() { return tags_; }
  DeviceArray<Tag> const& tags() const { return tags_; }
  DeviceArray<Tag> take_tags() { return std::move(tags_); }
  /// Nothing to do: kernels read the tags.
  void regroup() {}

  Index patch_size() const { return cuts_.size(); }
  Index patch_count() const { return cuts_.count(); }
  PatchRanges patches() const { return {first_.data(), of_run_.data(), cuts_.size()}; }
  std::span<Index const> patch_bounds() const { return cuts_.first(); }
  int threads() const { return threads_; }
  /// Whether accumulation takes fans of elements, where the kernel allows it.
  bool has_fans() const { return fans_.units.size() > 0; }
  View view(detail::ActiveList const& active) const {
    return {count_, connectivity_.data(), tag_data_, cuts_.size(), first_.data(), active};
  }
  detail::PatchView<detail::PatchRow<Nodes>> patch_view(detail::ActiveList const& active) const {
    return view_of(patches_, active);
  }
  detail::PatchView<detail::FanVisit> fan_view(detail::ActiveList const& active) const {
    return view_of(fans_, active);
  }

 private:
  using Planner = detail::PatchPlanner<Nodes>;

  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               std::vector<Tag> const& tags, Index nodes, ElementBlocks const& blocks = {},
               CudaElements const* before = nullptr)
      : count_(blocks.count(connectivity.size())) {
    detail::check_nodes(connectivity, nodes);
    tags_ = tags.empty() ? backend.template array<Tag>(static_cast<std::size_t>(count_))
                         : uploaded(backend, tags);
    tag_data_ = tags_.data();
    if (before != nullptr && blocks.some_stay())
      carry(backend, connectivity, blocks, *before);
    else
      connectivity_ = padded(backend, connectivity);
  }
  /// Puts what was given between the elements that stay.
  void carry(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
             ElementBlocks const& blocks, CudaElements const& before) {
    auto const first = uploaded(backend, blocks.first),
               sources = uploaded(backend, detail::sources_of(blocks)),
               rows = uploaded(backend, all_of(connectivity));
    connectivity_ = backend.template array<Index>(static_cast<std::size_t>(count_) * View::width);
    backend.for_each(count_,
                     detail::CarryConnectivity<Nodes, View::width>{
                         first.data(), sources.data(), static_cast<Index>(blocks.stays.size()),
                         before.connectivity_.data(), rows.data(), connectivity_.data()});
  }

  template <class P>
  detail::PatchView<typename P::Unit> view_of(detail::PatchPlan<P> const& plan,
                                              detail::ActiveList const& active) const {
    return {cuts_.size(),      first_.data(),     plan.capacity,         tag_data_,
            plan.units.data(), plan.nodes.data(), plan.diagonals.data(), active};
  }
  void cut(Cuda<T> const& backend, int size, ElementBlocks const& blocks) {
    cuts_ = detail::PatchCuts(count_, size, blocks);
    first_ = uploaded(backend, cuts_.first());
    auto const runs = PatchRanges::runs(count_);
    of_run_ = backend.template array<Index>(static_cast<std::size_t>(runs));
    backend.for_each(runs, detail::PatchOfRun{first_.data(), cuts_.count(), of_run_.data()});
  }

  /// Of patches of a size, where they fit the GPU's shared memory and `is_fit` holds. `before`: null, or the plan before a change
  /// to blocks.
  template <class P, class IsFit>
  bool make(detail::PatchPlan<P>& plan, Cuda<T> const& backend, int size,
            ElementBlocks const& blocks, CudaElements const* before,
            detail::PatchPlan<P> const* known_plan, IsFit const& is_fit) {
    int const most = detail::most_shared_bytes(backend.device());
    if (size > most || detail::plan_bytes<P>(size) > most) return false;
    cut(backend, size, blocks);
    detail::KnownPatches<P> known;
    if (known_plan != nullptr && known_plan->units.size() > 0 && before->patch_size() == size)
      known = {known_plan, before->first_.data(), cuts_.known_from(before->cuts_, blocks)};
    bool fits = true;
    plan = detail::plan_patches<P>(
        backend, connectivity_, View::width, cuts_, first_.data(), known,
        [&](detail::PatchCounts const& capacity) {
          // With three fields of three components, and tags.
          fits = is_fit(capacity) && detail::PatchMemory<T, 3, 9>::bytes(capacity) + size <= most;
          return fits;
        });
    return fits;
  }
  void plan(Cuda<T> const& backend, NodeOrder order, ElementBlocks const& blocks,
            CudaElements const* before) {
    constexpr auto t = detail::fan_tuning<T>();
    bool const in_fans = order == NodeOrder::any_even && count_ >= t.least_elements;
    if (in_fans && plan_fans(backend, {t.patch_size, t.threads}, blocks, before)) return;
    plan(backend, tuned(count_), blocks, before);
  }
  void plan(Cuda<T> const& backend, std::array<int, 2> size_and_threads,
            ElementBlocks const& blocks = {}, CudaElements const* before = nullptr) {
    auto const [size, threads] = size_and_threads;
    threads_ = threads;
    if constexpr (detail::scatters<T, Nodes>) {
      cut(backend, size, blocks);
    } else {
      constexpr int small = detail::patch_tuning<T, Nodes>().small_size;
      auto const anything = [](auto const&) { return true; };
      auto const* const known = before == nullptr ? nullptr : &before->patches_;
      if (make(patches_, backend, size, blocks, before, known, anything) || size <= small) return;
      threads_ = small;
      (void)make(patches_, backend, small, blocks, before, known, anything);
    }
  }
  bool plan_fans(Cuda<T> const& backend, std::array<int, 2> size_and_threads,
                 ElementBlocks const& blocks = {}, CudaElements const* before = nullptr) {
    if constexpr (Nodes == detail::FanPlanner::nodes) {
      using detail::FanSplitter;
      auto const few_nodes = [](detail::PatchCounts const& capacity) {
        return capacity.nodes <= FanSplitter::most_nodes;
      };
      auto const [size, threads] = size_and_threads;
      auto const* const known = before == nullptr ? nullptr : &before->fans_;
      if (size > FanSplitter::most_elements ||
          !make(fans_, backend, size, blocks, before, known, few_nodes))
        return false;
      threads_ = threads;
      return has_fans();
    } else {
      return false;
    }
  }
  static std::array<int, 2> tuned(Index count) {
    constexpr auto t = detail::patch_tuning<T, Nodes>();
    if (count < t.large_from) return {t.small_size, t.small_size};
    return {t.patch_size, t.threads};
  }
  template <class Values>
  static auto uploaded(Cuda<T> const& backend, Values const& values) {
    using U = typename Values::value_type;
    return backend.array(std::span<U const>(values));
  }
  static std::span<Index const> all_of(std::vector<std::array<Index, Nodes>> const& connectivity) {
    if (connectivity.empty()) return {};
    return {connectivity.front().data(), Nodes * connectivity.size()};
  }
  static DeviceArray<Index> padded(Cuda<T> const& backend,
                                   std::vector<std::array<Index, Nodes>> const& connectivity) {
    if constexpr (View::width == Nodes) {
      return uploaded(backend, all_of(connectivity));
    } else {
      std::vector<Index> rows(connectivity.size() * View::width);
      for (std::size_t e = 0; e < connectivity.size(); ++e)
        for (std::size_t a = 0; a < Nodes; ++a) rows[e * View::width + a] = connectivity[e][a];
      return uploaded(backend, rows);
    }
  }

  Index count_ = 0;
  int threads_ = 1;
  detail::PatchCuts cuts_;
  DeviceArray<Index> first_, of_run_;  // see PatchRanges
  DeviceArray<Tag> tags_;
  Tag const* tag_data_ = nullptr;  // whoever owns them
  DeviceArray<Index> connectivity_;
  detail::PatchPlan<Planner> patches_;
  detail::PatchPlan<detail::FanPlanner> fans_;  // in place of the others
};

}  // namespace pliant

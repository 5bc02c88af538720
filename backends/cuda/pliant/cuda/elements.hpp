#pragma once

#include <array>
#include <concepts>
#include <vector>

#include <pliant/backend/check_nodes.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_memory.cuh>
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
  int patch_size;
  ActiveList active;

  /// The i-th element of the active patches; negative where the last patch has none.
  __device__ __forceinline__ Index element(Index i) const {
    if (active.list != nullptr) {
      Index const patch = active.patch(i / patch_size);
      i = patch < 0 ? count : patch * patch_size + i % patch_size;
    }
    return i < count ? i : -1;
  }
};

/// The patches of an element table as kernels see them.
template <int Nodes>
struct PatchView {
  Index count;                                               // elements
  int patch_size, rounds, node_capacity, diagonal_capacity;  // rounds of the block's threads
  Tag const* tags;
  PatchRow<Nodes> const* rows;     // (elements)
  PatchNode const* nodes;          // (patches, node_capacity)
  std::uint16_t const* diagonals;  // (patches, diagonal_capacity)
  ActiveList active;
};

}  // namespace detail

/// Connectivity, tags and patches on the device.
template <std::floating_point T, int Nodes>
class CudaElements {
  using View = detail::ElementView<Nodes>;

 public:
  static constexpr int nodes_per_element = Nodes;
  CudaElements() = default;
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               int /* groups */, std::vector<Tag> const& tags, Index nodes)
      : CudaElements(backend, connectivity, tags, nodes, tuned(connectivity.size())) {}
  /// With patches of a given size and threads per block, for tuning; small ones where the GPU has no room in
  /// shared memory for those. Throws Error when the size is no multiple of the threads.
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               std::vector<Tag> const& tags, Index nodes, std::array<int, 2> size_and_threads)
      : count_(static_cast<Index>(connectivity.size())),
        patch_size_(size_and_threads[0]),
        threads_(size_and_threads[1]) {
    if (threads_ < 1 || patch_size_ < threads_ || patch_size_ % threads_ != 0)
      throw Error("patches of ", patch_size_, " elements for ", threads_,
                  " threads; give a multiple of the threads");
    detail::check_nodes(connectivity, nodes);
    tags_ = uploaded(backend, tags);
    tag_data_ = tags_.data();
    connectivity_ = padded(backend, connectivity);
    if constexpr (!detail::scatters<T, Nodes>) plan(backend);
  }

  Index count() const { return count_; }
  Index scratch_nodes() const { return 0; }
  DeviceArray<Tag>& tags() { return tags_; }
  DeviceArray<Tag> const& tags() const { return tags_; }
  DeviceArray<Tag> take_tags() { return std::move(tags_); }
  /// Nothing to do: kernels read the tags.
  void regroup() {}

  Index patch_size() const { return patch_size_; }
  Index patch_count() const { return count_ / patch_size_ + (count_ % patch_size_ != 0); }
  int threads() const { return threads_; }
  View view(detail::ActiveList const& active) const {
    return {count_, connectivity_.data(), tag_data_, patch_size_, active};
  }
  detail::PatchView<Nodes> patch_view(detail::ActiveList const& active) const {
    return {count_,    patch_size_,  patch_size_ / threads_, node_capacity_,    diagonal_capacity_,
            tag_data_, rows_.data(), nodes_.data(),          diagonals_.data(), active};
  }

 private:
  void plan(Cuda<T> const& backend) {
    constexpr int small = detail::patch_tuning<T, Nodes>().small_size;
    int const most = detail::most_shared_bytes(backend.device());
    auto const make = [&] {
      return detail::plan_patches<Nodes>(backend, connectivity_, count_, View::width, patch_size_);
    };
    bool const can_be_planned =
        patch_size_ <= most && detail::plan_bytes<Nodes>(patch_size_) <= most;
    detail::PatchPlan<Nodes> plan;
    if (can_be_planned) plan = make();
    if (patch_size_ > small && (!can_be_planned || shared_bytes(plan) > most)) {
      patch_size_ = threads_ = small;
      plan = make();
    }
    node_capacity_ = plan.node_capacity;
    diagonal_capacity_ = plan.diagonal_capacity;
    rows_ = std::move(plan.rows);
    nodes_ = std::move(plan.nodes);
    diagonals_ = std::move(plan.diagonals);
  }
  /// What accumulation takes of a block's shared memory with three fields of three components.
  static int shared_bytes(detail::PatchPlan<Nodes> const& plan) {
    using Memory = detail::PatchMemory<T, Nodes, 3, 9>;
    return Memory::bytes(plan.diagonal_capacity, plan.node_capacity, plan.patch_size);
  }
  static std::array<int, 2> tuned(std::size_t count) {
    constexpr auto t = detail::patch_tuning<T, Nodes>();
    if (static_cast<Index>(count) < t.large_from) return {t.small_size, t.small_size};
    return {t.patch_size, t.threads};
  }
  template <class U>
  static DeviceArray<U> uploaded(Cuda<T> const& backend, std::vector<U> const& values) {
    auto array = backend.template array<U>(values.size());
    array.upload(values);
    return array;
  }
  static DeviceArray<Index> padded(Cuda<T> const& backend,
                                   std::vector<std::array<Index, Nodes>> const& connectivity) {
    std::vector<Index> rows(connectivity.size() * View::width);
    for (std::size_t e = 0; e < connectivity.size(); ++e)
      for (std::size_t a = 0; a < Nodes; ++a) rows[e * View::width + a] = connectivity[e][a];
    return uploaded(backend, rows);
  }

  Index count_ = 0;
  int patch_size_ = 1, threads_ = 1, node_capacity_ = 0, diagonal_capacity_ = 0;
  DeviceArray<Tag> tags_;
  Tag const* tag_data_ = nullptr;  // whoever owns them
  DeviceArray<Index> connectivity_;
  DeviceArray<detail::PatchNode> nodes_;
  DeviceArray<detail::PatchRow<Nodes>> rows_;
  DeviceArray<std::uint16_t> diagonals_;
};

}  // namespace pliant

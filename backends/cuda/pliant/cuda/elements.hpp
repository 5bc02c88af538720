#pragma once

#include <array>
#include <concepts>
#include <vector>

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/patch_plan.hpp>
#include <pliant/cuda/tuning.hpp>

namespace pliant {

template <std::floating_point T>
class Cuda;

namespace detail {

/// An element table as kernels see it.
template <int Nodes>
struct ElementView {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  Index count;
  Index const* connectivity;  // (elements, width)
  Tag const* tags;
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
};

}  // namespace detail

/// Connectivity, tags and patches on the device.
template <std::floating_point T, int Nodes>
class CudaElements {
  using View = detail::ElementView<Nodes>;

 public:
  CudaElements() = default;
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               int /* groups */, std::vector<Tag> const& tags, Index nodes)
      : CudaElements(backend, connectivity, tags, nodes, tuned(connectivity.size())) {}
  /// With patches of a given size and threads per block, for tuning. Throws Error when the size is no
  /// multiple of the threads.
  CudaElements(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
               std::vector<Tag> const& tags, Index nodes, std::array<int, 2> size_and_threads)
      : count_(static_cast<Index>(connectivity.size())), threads_(size_and_threads[1]) {
    if (threads_ < 1 || size_and_threads[0] % threads_ != 0)
      throw Error("patches of ", size_and_threads[0], " elements for ", threads_,
                  " threads; give a multiple of the threads");
    detail::check_nodes<Nodes>(connectivity, nodes);
    tags_ = uploaded(backend, tags);
    tag_data_ = tags_.data();
    connectivity_ = padded(backend, connectivity);
    if constexpr (!detail::scatters<T, Nodes>)
      plan(backend, connectivity, nodes, size_and_threads[0]);
  }

  Index count() const { return count_; }
  Index scratch_nodes() const { return 0; }
  DeviceArray<Tag>& tags() { return tags_; }
  DeviceArray<Tag> const& tags() const { return tags_; }
  DeviceArray<Tag> take_tags() { return std::move(tags_); }
  /// Nothing to do: kernels read the tags.
  void regroup() {}

  Index patches() const { return patches_; }
  int threads() const { return threads_; }
  View view() const { return {count_, connectivity_.data(), tag_data_}; }
  detail::PatchView<Nodes> patch_view() const {
    return {count_,    patch_size_,  patch_size_ / threads_, node_capacity_,   diagonal_capacity_,
            tag_data_, rows_.data(), nodes_.data(),          diagonals_.data()};
  }

 private:
  void plan(Cuda<T> const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
            Index nodes, int patch_size) {
    auto const plan = detail::PatchPlanner<Nodes>(connectivity, nodes, patch_size).plan();
    patch_size_ = plan.patch_size;
    patches_ = plan.patches;
    node_capacity_ = plan.node_capacity;
    diagonal_capacity_ = plan.diagonal_capacity;
    rows_ = uploaded(backend, plan.rows);
    nodes_ = uploaded(backend, plan.nodes);
    diagonals_ = uploaded(backend, plan.diagonals);
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

  Index count_ = 0, patches_ = 0;
  int threads_ = 1, patch_size_ = 0, node_capacity_ = 0, diagonal_capacity_ = 0;
  DeviceArray<Tag> tags_;
  Tag const* tag_data_ = nullptr;  // whoever owns them
  DeviceArray<Index> connectivity_;
  DeviceArray<detail::PatchNode> nodes_;
  DeviceArray<detail::PatchRow<Nodes>> rows_;
  DeviceArray<std::uint16_t> diagonals_;
};

}  // namespace pliant

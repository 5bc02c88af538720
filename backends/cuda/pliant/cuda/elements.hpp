#pragma once

#include <array>
#include <concepts>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/element_blocks.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/element_patches.hpp>
#include <pliant/cuda/element_views.cuh>

namespace pliant {

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
    patches_.plan(backend, order, blocks, patches_of(before));
  }
  /// The same of rows that are on the device, whose numbers of nodes are not looked at: see TakesRows. With a table before a
  /// change, which has to stay so long, patches are not there before settle.
  CudaElements(Cuda<T> const& backend, DeviceArray<Index> rows, int /* groups */,
               DeviceArray<Tag> tags, Index /* nodes */, NodeOrder order = NodeOrder::as_given,
               ElementBlocks const& blocks = {}, CudaElements const* before = nullptr)
      : count_(blocks.count(rows.size() / row_width)),
        tags_(std::move(tags)),
        connectivity_(std::move(rows)) {
    if (tags_.size() == 0) tags_ = backend.template array<Tag>(static_cast<std::size_t>(count_));
    tag_data_ = tags_.data();
    patches_ = {connectivity_.data(), count_};
    if (before != nullptr)
      patches_.plan_beside(backend, order, blocks, before->patches_);
    else
      patches_.plan(backend, order, blocks);
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
    if (order == NodeOrder::any_even && patches_.plan_fans(backend, size_and_threads)) return;
    patches_.plan(backend, size_and_threads);
  }

  Index count() const { return count_; }
  ElementRows rows_of_nodes() const { return {connectivity_.data(), View::width}; }
  Index scratch_nodes() const { return 0; }
  DeviceArray<Tag>& tags() { return tags_; }
  DeviceArray<Tag> const& tags() const { return tags_; }
  DeviceArray<Tag> take_tags() { return std::move(tags_); }
  /// Nothing to do: kernels read the tags.
  void regroup() {}
  /// Waits for patches that are being planned.
  void settle(Cuda<T> const& backend) { patches_.settle(backend); }

  Index patch_size() const { return patches_.size(); }
  Index patch_count() const { return patches_.count(); }
  PatchRanges patches() const { return patches_.ranges(); }
  std::span<Index const> patch_bounds() const { return patches_.bounds(); }
  int threads() const { return patches_.threads(); }
  /// Whether accumulation takes fans of elements, where the kernel allows it.
  bool has_fans() const { return patches_.has_fans(); }
  View view(detail::ActiveList const& active) const {
    return {count_, connectivity_.data(), tag_data_, patch_size(), patches().first, active};
  }
  detail::PatchView<detail::PatchRow<Nodes>> patch_view(detail::ActiveList const& active) const {
    return patches_.patch_view(tag_data_, active);
  }
  detail::PatchView<detail::FanVisit> fan_view(detail::ActiveList const& active) const {
    return patches_.fan_view(tag_data_, active);
  }

 private:
  using Patches = detail::ElementPatches<T, Nodes>;

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
    patches_ = {connectivity_.data(), count_};
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

  static Patches const* patches_of(CudaElements const* before) {
    return before == nullptr ? nullptr : &before->patches_;
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
  DeviceArray<Tag> tags_;
  Tag const* tag_data_ = nullptr;  // whoever owns them
  DeviceArray<Index> connectivity_;
  Patches patches_;
};

}  // namespace pliant

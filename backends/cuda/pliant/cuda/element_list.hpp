#pragma once

#include <cstddef>
#include <utility>

#include <pliant/cuda/elements.hpp>

namespace pliant {

/// Rows of nodes and tags on the device, without patches: for verbs that accumulate nothing (see backend/elements_of_rows.hpp).
template <std::floating_point T, int Nodes>
class CudaElementList {
  using View = detail::ElementView<Nodes>;

 public:
  static constexpr int nodes_per_element = Nodes, row_width = View::width;
  CudaElementList() = default;
  /// `rows`: of row_width entries. Without tags all elements are of group 0. Numbers of nodes are not looked at.
  CudaElementList(Cuda<T> const& backend, DeviceArray<Index> rows, DeviceArray<Tag> tags = {})
      : count_(static_cast<Index>(rows.size() / row_width)),
        rows_(std::move(rows)),
        tags_(std::move(tags)) {
    if (tags_.size() == 0) tags_ = backend.template array<Tag>(static_cast<std::size_t>(count_));
  }

  Index count() const { return count_; }
  ElementRows rows_of_nodes() const { return {rows_.data(), row_width}; }
  DeviceArray<Tag>& tags() { return tags_; }
  DeviceArray<Tag> const& tags() const { return tags_; }
  /// All elements are one patch for loops that ask for one.
  Index patch_count() const { return count_ > 0 ? 1 : 0; }
  Index patch_size() const { return count_; }
  View view(detail::ActiveList const&) const {
    return {count_, rows_.data(), tags_.data(), count_, nullptr, {}};
  }

 private:
  Index count_ = 0;
  DeviceArray<Index> rows_;
  DeviceArray<Tag> tags_;
};

}  // namespace pliant

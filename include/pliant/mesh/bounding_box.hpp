#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include <pliant/backend/host_threads.hpp>

namespace pliant {

/// The lowest and the highest coordinates of points, infinite where there are none.
template <std::size_t Dim>
struct BoundingBox {
  std::array<double, Dim> low, high;

  BoundingBox() {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
  }
  explicit BoundingBox(std::span<std::array<double, Dim> const> points)
      : BoundingBox(static_cast<Index>(points.size()),
                    [&](Index i) -> auto& { return points[static_cast<std::size_t>(i)]; }) {}
  /// Of point_of(i) for i < count.
  template <std::invocable<Index> PointOf>
  BoundingBox(Index count, PointOf const& point_of) : BoundingBox() {
    detail::HostParts const parts(count);
    std::vector<BoundingBox> boxes(static_cast<std::size_t>(parts.count()));
    parts([&](Index first, Index last, int part) {
      BoundingBox box;
      for (Index i = first; i < last; ++i) box.include(point_of(i));
      boxes[static_cast<std::size_t>(part)] = box;
    });
    for (BoundingBox const& box : boxes) {
      include(box.low);
      include(box.high);
    }
  }

 private:
  void include(std::array<double, Dim> const& p) {
    for (std::size_t k = 0; k < Dim; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <limits>
#include <utility>

namespace pliant {

/// Who makes changes of a mesh that a body's backend can make: behind one that the host has to make, the host makes some of these,
/// since to bring the mesh over takes about as long. A body that changes by turns stays on the host.
class HostChanges {
 public:
  static constexpr int some = 2;

  /// Whether the host makes the next one, which the backend could make.
  bool take_next() {
    takes_next_ = left_ > 0;
    return takes_next_;
  }
  /// When the host has made one.
  void made() { left_ = std::exchange(takes_next_, false) ? left_ - 1 : std::max(left_, some); }
  /// The host makes all.
  void take_all() { left_ = std::numeric_limits<int>::max(); }

 private:
  int left_ = 0;
  bool takes_next_ = false;
};

}  // namespace pliant

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <mutex>

namespace pliant::detail {

/// Small blocks of a device's memory that were given back on a stream, for work that is queued there later: a call of the
/// driver for each takes about a microsecond, which in changes of a mesh adds up. Blocks have sizes that are powers of two.
/// Any thread may call any of these.
class SmallBlocks {
 public:
  static constexpr std::size_t smallest = 256, sizes = 9, largest = smallest << (sizes - 1);
  static constexpr std::size_t most_of_a_size = 64;

  static constexpr bool is_small(std::size_t bytes) { return bytes <= largest; }
  /// How large the block for so many bytes is.
  static constexpr std::size_t size_for(std::size_t bytes) {
    return std::bit_ceil(std::max(bytes, smallest));
  }

  /// A block for so many bytes, with values of before; nullptr where none is here.
  void* take(std::size_t bytes) {
    std::scoped_lock const lock(mutex_);
    Kept& kept = kept_for(bytes);
    return kept.count > 0 ? kept.blocks[--kept.count] : nullptr;
  }
  /// Keeps a block for so many bytes; false where there are enough of its size.
  bool keep(void* block, std::size_t bytes) {
    std::scoped_lock const lock(mutex_);
    Kept& kept = kept_for(bytes);
    if (kept.count == most_of_a_size) return false;
    kept.blocks[kept.count++] = block;
    return true;
  }
  /// Hands over all that are here.
  template <class Release>
  void clear(Release const& release) {
    std::scoped_lock const lock(mutex_);
    for (Kept& kept : kept_)
      while (kept.count > 0) release(kept.blocks[--kept.count]);
  }

 private:
  struct Kept {
    std::array<void*, most_of_a_size> blocks{};
    std::size_t count = 0;
  };

  Kept& kept_for(std::size_t bytes) {
    return kept_[static_cast<std::size_t>(std::countr_zero(size_for(bytes) / smallest))];
  }

  std::mutex mutex_;
  std::array<Kept, sizes> kept_;
};

}  // namespace pliant::detail

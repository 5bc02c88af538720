#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <mutex>

namespace pliant::detail {

/// Small blocks of a device's memory that were given back on a stream, for work that is queued there later: a call of the
/// driver for each takes a microsecond or more, which in changes of a mesh adds up. Blocks have four sizes between one power of two and
/// the next. Any thread may call any of these.
class SmallBlocks {
 public:
  static constexpr std::size_t smallest = 256, largest = std::size_t{4} << 20;
  static constexpr std::size_t most_of_a_size = 64, most_bytes_of_a_size = std::size_t{8} << 20;

  static constexpr bool is_small(std::size_t bytes) { return bytes <= largest; }
  /// How large the block for so many bytes is.
  static constexpr std::size_t size_for(std::size_t bytes) {
    if (bytes <= smallest) return smallest;
    std::size_t const step = std::bit_floor(bytes - 1) / sizes_of_power;
    return (bytes + step - 1) / step * step;
  }
  /// How many blocks of a size are kept.
  static constexpr std::size_t most_of(std::size_t size) {
    return std::min(most_of_a_size, most_bytes_of_a_size / size);
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
    if (kept.count == most_of(size_for(bytes))) return false;
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

  static constexpr std::size_t sizes_of_power = 4;
  /// The number of a size, ascending.
  static constexpr std::size_t number_of(std::size_t size) {
    if (size == smallest) return 0;
    std::size_t const power = std::bit_floor(size - 1), step = power / sizes_of_power;
    auto const before = static_cast<std::size_t>(std::countr_zero(power / smallest));
    return sizes_of_power * before + (size - power) / step;
  }

  Kept& kept_for(std::size_t bytes) { return kept_[number_of(size_for(bytes))]; }

  std::mutex mutex_;
  std::array<Kept, 1 + sizes_of_power * std::countr_zero(largest / smallest)> kept_;
};

}  // namespace pliant::detail

#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace pliant {

/// A checksum of bytes, eight at a time: each step maps the 2⁶⁴ sums one-to-one, so that a change within any
/// eight bytes always shows, and others do but for one in 2⁶⁴.
[[nodiscard]] inline std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t sum = bytes.size() + 1;
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    std::size_t const size = bytes.size() < sizeof word ? bytes.size() : sizeof word;
    std::memcpy(&word, bytes.data(), size);
    bytes.remove_prefix(size);
    sum = std::rotl(sum ^ word, 29) * 0x9e3779b97f4a7c15u;
    sum ^= sum >> 32;
  }
  return sum;
}

}  // namespace pliant

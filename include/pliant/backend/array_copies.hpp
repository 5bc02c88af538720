#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <pliant/backend/backend.hpp>

namespace pliant::detail {

/// Copies bytes between several arrays, a word at a time, and sets those behind them to zero.
struct CopyWords {
  struct alignas(16) Word {
    std::uint32_t bits[4];
  };
  /// Word k of one array. Arrays begin at a boundary of a word; the last word may be cut off.
  struct Span {
    std::byte const* from = nullptr;
    std::byte* to = nullptr;
    std::size_t kept = 0, bytes = 0;

    [[nodiscard]] PLIANT_HOST_DEVICE std::size_t words() const {
      return (bytes + sizeof(Word) - 1) / sizeof(Word);
    }
    PLIANT_HOST_DEVICE void copy(std::size_t k) const {
      std::size_t const first = k * sizeof(Word), last = first + sizeof(Word);
      if (last <= kept)
        reinterpret_cast<Word*>(to)[k] = reinterpret_cast<Word const*>(from)[k];
      else if (first >= kept && last <= bytes)
        reinterpret_cast<Word*>(to)[k] = {};
      else
        for (std::size_t i = first; i < last && i < bytes; ++i)
          to[i] = i < kept ? from[i] : std::byte{0};
    }
  };
  static constexpr std::size_t most = 12;

  std::array<Span, most> spans{};
  std::size_t first = 0;  // word of all

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    std::size_t k = first + static_cast<std::size_t>(i);
    for (auto const& span : spans) {
      if (k < span.words()) return span.copy(k);
      k -= span.words();
    }
  }
};

/// Longer or equal copies of arrays in a backend's memory, which one loop makes.
template <Backend B>
class ArrayCopies {
 public:
  explicit ArrayCopies(B const& backend) : backend_(backend) {}
  ArrayCopies(ArrayCopies const&) = delete;
  ArrayCopies& operator=(ArrayCopies const&) = delete;

  /// An array of `count` values, the first of which are to be those of another one, as many as that has, and the others zero.
  /// Both have to be there when the copies are made.
  template <class U>
  auto extended(typename B::template Array<U> const& from, std::size_t count) {
    return copy_of(from.data(), std::min(from.size(), count), count);
  }
  /// The same of the first `kept` values of some.
  template <class U>
  auto copy_of(U const* from, std::size_t kept, std::size_t count) {
    if (spans_ == CopyWords::most) make();
    auto copy = unset<U>(backend_, count);
    words_.spans[spans_] = {reinterpret_cast<std::byte const*>(from),
                            reinterpret_cast<std::byte*>(copy.data()), kept * sizeof(U),
                            count * sizeof(U)};
    in_all_ += words_.spans[spans_++].words();
    return copy;
  }
  /// Makes the copies that were asked for.
  void make() {
    constexpr std::size_t most = std::numeric_limits<Index>::max();
    for (words_.first = 0; words_.first < in_all_; words_.first += most)
      backend_.for_each(static_cast<Index>(std::min(most, in_all_ - words_.first)), words_);
    words_ = {};
    spans_ = in_all_ = 0;
  }

 private:
  B const& backend_;
  CopyWords words_;
  std::size_t spans_ = 0, in_all_ = 0;
};

}  // namespace pliant::detail

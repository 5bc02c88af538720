#pragma once

#include <bit>
#include <limits>

#include <pliant/backend/backend.hpp>
#include <pliant/body/criteria_workspace.hpp>

// A radix search, most significant digit first, over ordered bits of values and over numbers. Each digit is one
// histogram and a kernel of one thread; nothing comes to the host.
namespace pliant::detail {

/// The digit of a key at a shift, with what it weighs; nothing where the digits before are not `prefix`.
template <class Key>
PLIANT_HOST_DEVICE Bin digit_of(Key key, Key prefix, int shift, bool first, std::int64_t weight) {
  constexpr int bits = 8 * int{sizeof(Key)};
  bool const candidate = first || shift + 8 >= bits || (key >> (shift + 8)) == prefix;
  return candidate ? Bin{static_cast<int>(key >> shift & 255), weight} : Bin{-1, 0};
}

/// The power of two by which no sum of so many values up to the largest reaches 2⁶².
template <class T>
PLIANT_HOST_DEVICE double scale_for(OrderedBits<T> largest, Index elements) {
  using Key = OrderedBits<T>;
  constexpr int mantissa = std::numeric_limits<T>::digits - 1;
  constexpr int most = std::numeric_limits<T>::max_exponent - 1;  // the bias of exponents
  constexpr Key sign = Key{1} << (8 * sizeof(T) - 1);
  if ((largest & sign) == 0) return 1;  // nothing is positive, and weighs
  int const exponent = static_cast<int>((largest ^ sign) >> mantissa) - most + 1;
  if (exponent > most + 1) return 0;
  int bits = 62;
  for (Index n = elements; n > 0; n /= 2) --bits;
  // Of double, whatever T is: small values of float need a scale beyond its range.
  constexpr int bias = std::numeric_limits<double>::max_exponent - 1;
  int const power = min(bits - exponent, bias);
  return std::bit_cast<double>(static_cast<std::uint64_t>(power + bias) << 52);
}

/// The weight of all that a histogram counts.
PLIANT_HOST_DEVICE std::int64_t total_of(std::int64_t const* histogram) {
  std::int64_t total = 0;
  for (int k = 0; k < histogram_bins; ++k) total += histogram[k];
  return total;
}

/// Sets the scale by which sums of values up to the largest, whose leading digits were found down to a shift, are
/// whole numbers.
template <class T>
PLIANT_HOST_DEVICE void set_scale(Ranking<T>& r, int shift, Index elements) {
  r.scale = scale_for<T>(static_cast<OrderedBits<T>>(((r.prefix + 1) << shift) - 1), elements);
}

/// The shift of the first digit of values, of sign and exponent, and of numbers below a count.
template <class T>
inline constexpr int top_digit = 8 * int{sizeof(T)} - 8;
inline int top_digit_of_numbers(Index count) {
  int top = 0;
  while (top < 24 && (count - 1) >> (top + 8) > 0) top += 8;
  return top;
}

/// Finds the digit at which `r.remaining` is reached among those of a histogram, from the largest or the smallest on,
/// and clears that. Returns the weight at this digit.
template <class T>
PLIANT_HOST_DEVICE std::int64_t take_digit(Ranking<T>& r, std::int64_t* histogram, bool ascending) {
  constexpr int bins = histogram_bins;
  std::int64_t left = r.remaining, weight = 0;
  int found = -1;
  for (int k = 0; k < bins; ++k) {
    int const bin = ascending ? k : bins - 1 - k;
    std::int64_t const here = histogram[bin];
    bool const reaches = found < 0 && here >= left;
    found = reaches ? bin : found;
    weight = reaches ? here : weight;
    left = found < 0 ? left - here : left;
  }
  for (int k = 0; k < bins; ++k) histogram[k] = 0;
  if (r.state == Ranking<T>::searching) {
    r.remaining = left;
    r.prefix = static_cast<OrderedBits<T>>(r.prefix << 8 | static_cast<OrderedBits<T>>(found));
  }
  return weight;
}

template <class T>
struct StartRanking {
  Ranking<T>* ranking;
  Cut<T> cut;
  PLIANT_HOST_DEVICE void operator()(Index) const { ranking->cut = cut; }
};

}  // namespace pliant::detail

#pragma once

#include <pliant/adaptation/marking.hpp>
#include <pliant/body/criteria_workspace.hpp>

// Which elements a rule by share, bulk, budget or fraction of the largest marks: a radix search, most
// significant digit first, over the ordered bits of the values and, among equal values, over the
// elements' numbers. Each digit is one histogram and a kernel of one thread; nothing comes to the host.
namespace pliant::detail {

/// The values that one rule compares with each other: those of the elements that it may mark.
template <class T>
struct RankedValues {
  T const* values;              // (elements)
  Candidate const* candidates;  // (elements)
  Index const* number;          // (elements): in the order of which equal values act
  Index elements;
  T sign;  // −1: the smallest act first
};

enum class Search {
  highest,  ///< the largest value of all that are looked at
  largest,  ///< the largest value of those that may act
  bulk,     ///< the largest values that add up to a share of the sum
  count,    ///< so many of the largest values
  tie       ///< among values equal to the last that `count` takes: so many by number
};

/// The digit of a key at a shift, with what it weighs; nothing where the digits before are not `prefix`.
template <class Key>
PLIANT_HOST_DEVICE Bin digit_of(Key key, Key prefix, int shift, bool first, std::int64_t weight) {
  constexpr int bits = 8 * int{sizeof(Key)};
  bool const candidate = first || shift + 8 >= bits || (key >> (shift + 8)) == prefix;
  return candidate ? Bin{static_cast<int>(key >> shift & 255), weight} : Bin{-1, 0};
}

/// The digit of an element's value or number, and what it weighs.
template <class T>
struct Digit {
  RankedValues<T> ranked;
  Ranking<T> const* ranking;
  Search search;
  int shift;
  bool first;

  PLIANT_HOST_DEVICE Bin operator()(Index e) const {
    if ((!first || search == Search::tie) && ranking->state != Ranking<T>::searching)
      return {-1, 0};
    Candidate const own = ranked.candidates[e];
    if (own == Candidate::none || (own == Candidate::looked_at && search != Search::highest))
      return {-1, 0};
    T const value = ranked.sign * ranked.values[e];
    if (!(value == value)) return {-1, 0};
    if (search == Search::tie)
      return ordered_bits(value) == ranking->key
                 ? digit(static_cast<std::uint32_t>(ranked.number[e]), 1)
                 : Bin{-1, 0};
    return digit(ordered_bits(value), search == Search::bulk ? weight(value) : 1);
  }

 private:
  template <class Key>
  PLIANT_HOST_DEVICE Bin digit(Key key, std::int64_t weight) const {
    return digit_of(key, static_cast<Key>(ranking->prefix), shift, first, weight);
  }
  PLIANT_HOST_DEVICE std::int64_t weight(T value) const {
    if (ranking->scale == 0) return value > std::numeric_limits<T>::max() ? 1 : 0;
    return value > T(0) ? static_cast<std::int64_t>(static_cast<double>(value) * ranking->scale)
                        : 0;
  }
};

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

/// Finds the next digit of the value that is searched from the histogram, and clears that.
template <class T>
struct NarrowRanking {
  using Key = OrderedBits<T>;
  MarkingKind kind;
  double amount;
  std::int64_t budget;
  Index elements;
  Search search;
  int shift;
  bool first, last;
  std::int64_t* histogram;
  Ranking<T>* ranking;

  PLIANT_HOST_DEVICE void operator()(Index) const {
    Ranking<T>& r = *ranking;
    if (first) begin(r);
    (void)take_digit(r, histogram, search == Search::tie);
    if (last) finish(r);
  }

 private:
  PLIANT_HOST_DEVICE void begin(Ranking<T>& r) const {
    r.prefix = 0;
    if (search == Search::tie) return;
    std::int64_t total = 0;
    for (int k = 0; k < histogram_bins; ++k) total += histogram[k];
    r.remaining = 1;
    if (search == Search::count) {
      r.remaining = budget;
      if (kind == MarkingKind::top_share) {
        // The product may be rounded to below the number that is meant.
        constexpr double slack = 1 + 4 * std::numeric_limits<double>::epsilon();
        r.remaining = min(r.remaining,
                          static_cast<std::int64_t>(amount * slack * static_cast<double>(total)));
      }
    } else if (search == Search::bulk) {
      double const wanted = amount * static_cast<double>(total);
      auto const whole = static_cast<std::int64_t>(wanted);
      r.remaining = min(total, whole + (static_cast<double>(whole) < wanted ? 1 : 0));
    }
    r.state = total == 0 || r.remaining <= 0                    ? Ranking<T>::none
              : search == Search::count && r.remaining >= total ? Ranking<T>::all
                                                                : Ranking<T>::searching;
  }

  PLIANT_HOST_DEVICE void finish(Ranking<T>& r) const {
    if (r.state == Ranking<T>::none) {
      r.cut = Cut<T>::none();
    } else if (search == Search::largest) {
      r.scale = scale_for<T>(static_cast<Key>(((r.prefix + 1) << shift) - 1), elements);
    } else if (search == Search::highest) {
      constexpr T most = std::numeric_limits<T>::max();  // what is infinite counts as this
      T const largest = max(-most, min(from_ordered_bits<T>(r.prefix), most));
      r.cut.tighten({ordered_bits(static_cast<T>(amount * static_cast<double>(largest))), -1});
    } else if (search == Search::bulk) {
      r.cut.tighten({r.prefix, std::numeric_limits<Index>::max()});
    } else if (search == Search::count) {
      r.key = r.prefix;
    } else if (r.state == Ranking<T>::searching) {
      r.cut.tighten({r.key, static_cast<Index>(r.prefix)});
    }
  }
};

template <class T>
struct StartRanking {
  Ranking<T>* ranking;
  Cut<T> cut;
  PLIANT_HOST_DEVICE void operator()(Index) const { ranking->cut = cut; }
};

/// The cut that a marking makes among values, given in the backend's memory; nothing waits for it.
/// Counts are exact. A bulk is found from sums in fixed point, which depend on no order of additions: each of n
/// values is rounded down to a multiple of at most n 2⁻⁶⁰ of the largest. Negative values have no
/// weight in it.
template <Backend B, class T = typename B::scalar>
void find_cut(B const& backend, Marking const& m, RankedValues<T> const& ranked,
              std::int64_t* histogram, Ranking<T>* ranking) {
  backend.for_each(1, StartRanking<T>{ranking, {ordered_bits(m.template beyond<T>()), -1}});
  auto const find = [&](Search search, int from, int to) {
    for (int shift = from; shift >= to; shift -= 8) {
      backend.histogram(ranked.elements, Digit<T>{ranked, ranking, search, shift, shift == from},
                        histogram);
      backend.for_each(1, NarrowRanking<T>{m.kind, m.amount, m.budget, ranked.elements, search,
                                           shift, shift == from, shift == to, histogram, ranking});
    }
  };
  constexpr int top = 8 * int{sizeof(T)} - 8;
  if (m.kind == MarkingKind::fraction_of_largest) find(Search::highest, top, 0);
  if (m.kind == MarkingKind::bulk) {
    find(Search::largest, top, top - 8);  // sign and exponent
    find(Search::bulk, top, 0);
  }
  if (m.kind == MarkingKind::top_share || m.budget < ranked.elements) {
    find(Search::count, top, 0);
    int index_top = 0;
    while (index_top < 24 && (ranked.elements - 1) >> (index_top + 8) > 0) index_top += 8;
    find(Search::tie, index_top, 0);
  }
}

}  // namespace pliant::detail

#pragma once

#include <pliant/adaptation/marking.hpp>
#include <pliant/adaptation/radix_search.hpp>

// Which elements a rule by share, bulk, budget or fraction of the largest marks: a search for the digits of the last
// value that is marked and, among equal values, of the last element's number.
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

/// Finds the next digit of the value that is searched from the histogram, and clears that.
template <class T>
struct NarrowRanking {
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
    std::int64_t const total = total_of(histogram);
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
      set_scale(r, shift, elements);
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
  constexpr int top = top_digit<T>;
  if (m.kind == MarkingKind::fraction_of_largest) find(Search::highest, top, 0);
  if (m.kind == MarkingKind::bulk) {
    find(Search::largest, top, top - 8);  // sign and exponent
    find(Search::bulk, top, 0);
  }
  if (m.kind == MarkingKind::top_share || m.budget < ranked.elements) {
    find(Search::count, top, 0);
    find(Search::tie, top_digit_of_numbers(ranked.elements), 0);
  }
}

}  // namespace pliant::detail

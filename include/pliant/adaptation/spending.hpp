#pragma once

#include <pliant/adaptation/choice_of_element.hpp>
#include <pliant/adaptation/radix_search.hpp>

// Which offers a budget or a limit of the error takes: a search like that of ranking.hpp (see radix_search.hpp), over what offers are worth,
// where each weighs what it costs or the error that it takes away. Sums are whole numbers, exact in any order; nothing
// comes to the host. Other actions, of the mesh say, would join as further offers.
namespace pliant::detail {

enum class Weigh { error, cost };

enum class Spending {
  largest,  ///< the largest error, which says how finely errors are rounded
  total,    ///< the sum of errors, or of costs, before any offer is taken
  worth,    ///< what the last offer is worth that is taken
  tie       ///< among offers worth as much: so many by number
};

/// The digit of what an element offers, and its weight.
template <class Choice, class T>
struct SpendingDigit {
  Choice choice;
  Ranking<T> const* ranking;
  Weigh weigh;
  Spending search;
  int taken;  // the offer behind so many
  int shift;
  bool first;

  PLIANT_HOST_DEVICE Bin operator()(Index e) const {
    constexpr Bin none{-1, 0};
    int const present = choice.place_of(e);
    if (present < 0) return none;
    int from = choice.first_place(e, present);
    if (search == Spending::largest) return digit(ordered_bits(choice.known_error(e, from)), 1);
    if (search == Spending::total)
      return {0, weigh == Weigh::error ? whole_error(e, from)
                 : choice.sleeps(e)    ? 0
                                       : choice.whole_cost(e, from)};
    if (ranking->state != Ranking<T>::searching || choice.is_fixed(e)) return none;
    auto offer = choice.offer(e, from, present);
    for (int k = 0; k < taken && offer.to >= 0; ++k) {
      from = offer.to;
      offer = choice.offer(e, from, present);
    }
    if (offer.to < 0) return none;
    auto const key = ordered_bits(offer.worth);
    auto const weight = weigh == Weigh::error
                            ? whole_error(e, from) - whole_error(e, offer.to)
                            : choice.whole_cost(e, offer.to) - choice.whole_cost(e, from);
    if (search == Spending::worth) return digit(key, weight);
    return key == ranking->key ? digit(static_cast<std::uint32_t>(choice.number[e]), weight) : none;
  }

 private:
  template <class Key>
  PLIANT_HOST_DEVICE Bin digit(Key key, std::int64_t weight) const {
    return digit_of(key, static_cast<Key>(ranking->prefix), shift, first, weight);
  }
  PLIANT_HOST_DEVICE std::int64_t whole_error(Index e, int place) const {
    return static_cast<std::int64_t>(static_cast<double>(choice.known_error(e, place)) *
                                     ranking->scale);
  }
};

/// Finds the next digit from the histogram, and clears that.
template <class T>
struct NarrowSpending {
  Weigh weigh;
  double limit;  // J, or evaluations
  double units;  // of cost
  Index elements;
  Spending search;
  int shift;
  bool first, last;
  std::int64_t* histogram;
  Ranking<T>* ranking;

  PLIANT_HOST_DEVICE void operator()(Index) const {
    Ranking<T>& r = *ranking;
    if (search == Spending::total) return begin_with(r);
    if (first) begin(r);
    std::int64_t const weight = take_digit(r, histogram, search == Spending::tie);
    if (last) finish(r, weight);
  }

 private:
  /// What the offers that are taken weigh, at least or at most.
  PLIANT_HOST_DEVICE void begin_with(Ranking<T>& r) const {
    std::int64_t const total = histogram[0];
    histogram[0] = 0;
    constexpr double most = static_cast<double>(std::int64_t{1} << 62);
    double const sum = static_cast<double>(total);
    double const whole = limit * (weigh == Weigh::error ? r.scale : units);
    r.state = Ranking<T>::searching;
    if (weigh == Weigh::error) {
      if (!(whole < sum))
        r.state = Ranking<T>::none;
      else
        r.remaining = total - static_cast<std::int64_t>(whole);
    } else {
      // The product may be rounded to below the number that is meant.
      r.remaining = static_cast<std::int64_t>(min(whole + 0.5, most)) - total;
      if (r.remaining <= 0) r.state = Ranking<T>::none;
    }
  }
  PLIANT_HOST_DEVICE void begin(Ranking<T>& r) const {
    r.prefix = 0;
    if (search == Spending::tie) return;
    std::int64_t const total = total_of(histogram);
    if (search == Spending::largest) {
      r.remaining = 1;
      r.state = total == 0 ? Ranking<T>::none : Ranking<T>::searching;
    } else if (r.state == Ranking<T>::searching && total <= r.remaining) {
      r.state = Ranking<T>::all;
    }
  }
  PLIANT_HOST_DEVICE void finish(Ranking<T>& r, std::int64_t weight) const {
    if (search == Spending::largest) {
      set_scale(r, shift, elements);
    } else if (search == Spending::worth) {
      r.key = r.prefix;
      if (r.state == Ranking<T>::none) r.cut = Cut<T>::none();
    } else if (r.state == Ranking<T>::searching) {
      // The offer at the limit is taken where errors must go down to it, not where it would cost too much.
      bool const taken = weigh == Weigh::error || weight <= r.remaining;
      r.cut.tighten({r.key, static_cast<Index>(r.prefix) - (taken ? 0 : 1)});
    }
  }
};

/// The cut among all offers that limits of the error, J, and of the cost, evaluations, make; nothing waits for it.
template <Backend B, int Groups, int Count, class T = typename B::scalar>
void find_spending(B const& backend, ChoiceOfElement<T, Groups, Count> const& choice, double error,
                   double cost, std::int64_t* histogram, Ranking<T>* ranking) {
  using Choice = ChoiceOfElement<T, Groups, Count>;
  backend.for_each(1, StartRanking<T>{ranking, {0, -1}});
  auto const pass = [&](Weigh weigh, double limit, Spending search, int from, int to) {
    bool const of_offers = search == Spending::worth || search == Spending::tie;
    for (int shift = from; shift >= to; shift -= 8) {
      for (int taken = 0; taken < (of_offers ? Count - 1 : 1); ++taken)
        backend.histogram(
            choice.elements,
            SpendingDigit<Choice, T>{choice, ranking, weigh, search, taken, shift, shift == from},
            histogram);
      backend.for_each(
          1, NarrowSpending<T>{weigh, limit, choice.table.units, choice.elements, search, shift,
                               shift == from, shift == to, histogram, ranking});
    }
  };
  constexpr int top = top_digit<T>;
  auto const find = [&](Weigh weigh, double limit) {
    if (weigh == Weigh::error)
      pass(weigh, limit, Spending::largest, top, top - 8);  // sign and exponent
    pass(weigh, limit, Spending::total, 0, 0);
    pass(weigh, limit, Spending::worth, top, 0);
    pass(weigh, limit, Spending::tie, top_digit_of_numbers(choice.elements), 0);
  };
  if (error < std::numeric_limits<double>::infinity()) find(Weigh::error, error);
  if (cost < std::numeric_limits<double>::infinity()) find(Weigh::cost, cost);
}

}  // namespace pliant::detail

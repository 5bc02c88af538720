#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/adaptation/mesh_offers.hpp>

namespace pliant::detail {

/// What is offered of the elements of one type. Sums are of those that are open, and what was settled of the others.
class OffersOfType {
 public:
  OffersOfType() = default;
  OffersOfType(OffersOfType const&) = delete;
  OffersOfType& operator=(OffersOfType const&) = delete;
  virtual ~OffersOfType() = default;

  /// J.
  [[nodiscard]] virtual double error_now() const = 0;
  /// The largest worth of a change, and the inverse of the least above zero; 0 where there is none.
  [[nodiscard]] virtual double largest_worth() const = 0;
  [[nodiscard]] virtual double inverse_of_least_worth() const = 0;
  /// All are open from here on.
  virtual void open(OfferSum of) = 0;
  /// What limits make of all.
  [[nodiscard]] virtual double sum(OfferLimits const& limits) const = 0;
  /// Settles those of which two limits make the same, as do all between them. Whether others are left.
  virtual bool settle(OfferLimits const& one, OfferLimits const& other) = 0;
  /// Notes which elements go to other groups, and marks those that are to change.
  virtual void decide(OfferLimits const& limits, MarkBits& bits) const = 0;
};

/// Looks for the limits of what elements of several types offer.
class OfferSearch {
 public:
  /// Null pointers stand for types of which nothing is offered.
  OfferSearch(std::vector<std::unique_ptr<OffersOfType>> const& all, double release)
      : all_(all), release_(release) {}

  /// The largest limits that keep what is left of the error, or the least that keep the budget where these are larger;
  /// infinite: there is none. Towards an error no more is made than leaves a quarter of what there is: the rest is best known
  /// then. Undone is what neither asks for in the end.
  [[nodiscard]] OfferLimits limits_for(double error, double evaluations) const {
    double const most = largest(&OffersOfType::largest_worth);
    if (most == 0) return {1, 1};  // nothing is wrong anywhere: all is undone
    double const least = 1 / largest(&OffersOfType::inverse_of_least_worth);
    double const low = least / 2, high = 2 * most / release_;
    auto const search = [&](OfferSum of, auto const& limits_at, auto const& is_low) {
      open(of);
      double a = low, b = high;
      for (int k = 0; k < 60; ++k) {
        if (k > 0 && k % 4 == 0 && !settle(limits_at(a), limits_at(b))) break;
        double const middle = std::sqrt(a) * std::sqrt(b);
        (is_low(sum(limits_at(middle))) ? a : b) = middle;
      }
      return std::pair{a, b};
    };
    auto const both = [](double limit) { return OfferLimits{limit, limit}; };
    bool const has_error = std::isfinite(error);
    double const end =
        has_error ? search(OfferSum::error, both, [&](double left) { return left <= error; }).first
                  : low;
    if (std::isfinite(evaluations) && sum_of_all(OfferSum::evaluations, both(end)) > evaluations)
      return both(search(OfferSum::evaluations, both, [&](double left) {
                    return left > evaluations;
                  }).second);
    if (!has_error) return both(end);
    double quarter = 0;
    each([&](auto const& own) { quarter += own.error_now() / 4; });
    if (error >= quarter) return both(end);
    auto const until_end = [end](double limit) { return OfferLimits{limit, end}; };
    return until_end(
        search(OfferSum::error, until_end, [&](double left) { return left <= quarter; }).first);
  }

 private:
  template <class Visit>
  void each(Visit const& visit) const {
    for (auto const& own : all_)
      if (own) visit(*own);
  }
  double largest(double (OffersOfType::*of)() const) const {
    double found = 0;
    each([&](auto const& own) { found = std::max(found, (own.*of)()); });
    return found;
  }
  void open(OfferSum of) const {
    each([&](auto& own) { own.open(of); });
  }
  double sum(OfferLimits const& limits) const {
    double total = 0;
    each([&](auto const& own) { total += own.sum(limits); });
    return total;
  }
  double sum_of_all(OfferSum of, OfferLimits const& limits) const {
    open(of);
    return sum(limits);
  }
  bool settle(OfferLimits const& one, OfferLimits const& other) const {
    bool some = false;
    each([&](auto& own) { some = own.settle(one, other) || some; });
    return some;
  }

  std::vector<std::unique_ptr<OffersOfType>> const& all_;
  double release_;
};

}  // namespace pliant::detail

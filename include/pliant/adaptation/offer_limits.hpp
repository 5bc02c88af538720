#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/adaptation/mesh_offers.hpp>

namespace pliant::detail {

/// What is offered of the elements of one type.
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
  /// All are open from here on, and looked at for sums of one sort.
  virtual void open(OfferSum of) = 0;
  /// Adds what limits make of those that are open to a sum in the backend's memory.
  virtual void add_sum(TriedLimits const& limits, double* to) const = 0;
  /// Finds those of which two limits make the same, as do all between them: adds what that is to a sum, and counts the others.
  virtual void settle(TriedLimits const& one, TriedLimits const& other, double* settled,
                      Index* how_many) = 0;
  /// These are open from here on; so many were counted.
  virtual void leave_open(Index how_many) = 0;
  /// Notes which elements go to other groups, and marks those that are to change.
  virtual void decide(OfferLimits const& limits, MarkBits& bits) const = 0;
};

/// The range of a limit that is searched for, J per evaluation, and sums: of those that are open, and of the others.
struct OfferRange {
  double low = 0, high = 0, middle = 0;
  double open = 0, settled = 0;

  OfferRange() = default;
  explicit OfferRange(int) {}  // arrays begin zeroed
};
/// Halves a range, on a logarithmic scale, by what is left at its middle.
struct HalveRange {
  OfferRange* range;
  OfferSum of;
  double goal;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    auto& own = *range;
    double const left = own.open + own.settled;
    bool const is_low = of == OfferSum::error ? left <= goal : left > goal;
    (is_low ? own.low : own.high) = own.middle;
    own.middle = std::sqrt(own.low) * std::sqrt(own.high);
    own.open = 0;
  }
};

/// Looks for the limits of what elements of several types offer. The host waits once for several halvings.
template <Backend B>
class OfferSearch {
 public:
  /// Null pointers stand for types of which nothing is offered.
  OfferSearch(B const& backend, std::vector<std::unique_ptr<OffersOfType>> const& all,
              double release)
      : backend_(backend),
        all_(all),
        release_(release),
        range_(zeros<OfferRange>(backend, 1)),
        counts_(zeros<Index>(backend, all.size())) {}

  /// The largest limits that keep what is left of the error, or the least that keep the budget where these are larger;
  /// infinite: there is none. Towards an error no more is made than leaves a quarter of what there is: the rest is best known
  /// then. Undone is what neither asks for in the end.
  [[nodiscard]] OfferLimits limits_for(double error, double evaluations) {
    double const most = largest(&OffersOfType::largest_worth);
    if (most == 0) return {1, 1};  // nothing is wrong anywhere: all is undone
    low_ = 1 / largest(&OffersOfType::inverse_of_least_worth) / 2;
    high_ = std::min(2 * most / release_, std::numeric_limits<double>::max());
    auto const both = [](double limit) { return OfferLimits{limit, limit}; };
    bool const has_error = std::isfinite(error);
    double const end = has_error ? search(OfferSum::error, error, as_made_).low : low_;
    if (std::isfinite(evaluations) && evaluations_at(end) > evaluations)
      return both(search(OfferSum::evaluations, evaluations, as_made_).high);
    if (!has_error) return both(end);
    double quarter = 0;
    each([&](std::size_t, auto const& own) { quarter += own.error_now() / 4; });
    if (error >= quarter) return both(end);
    return {search(OfferSum::error, quarter, end).low, end};
  }

 private:
  static constexpr double as_made_ = std::numeric_limits<double>::quiet_NaN();
  static constexpr int at_once_ = 4;  // halvings
  /// What differs by less counts as equal, as errors of mirrored elements do but for rounding.
  static constexpr double resolution_ = 1e-12;

  template <class Visit>
  void each(Visit const& visit) const {
    for (std::size_t type = 0; type < all_.size(); ++type)
      if (all_[type]) visit(type, *all_[type]);
  }
  double largest(double (OffersOfType::*of)() const) const {
    double found = 0;
    each([&](std::size_t, auto const& own) { found = std::max(found, (own.*of)()); });
    return found;
  }
  void begin(OfferSum of, double low, double high, double middle) {
    OfferRange range;
    range.low = low;
    range.high = high;
    range.middle = middle;
    range_.upload(std::span<OfferRange const>(&range, 1));
    each([&](std::size_t, auto& own) { own.open(of); });
  }
  void add_sums(double undo) {
    auto* const range = range_.data();
    each([&](std::size_t, auto& own) { own.add_sum({&range->middle, undo}, &range->open); });
  }
  double evaluations_at(double limit) {
    begin(OfferSum::evaluations, limit, limit, limit);
    add_sums(as_made_);
    return download<OfferRange>(range_)[0].open;
  }
  /// Between limits of which those below keep an error, or exceed a budget, and those above do not, as close to each other as
  /// leaves one element of which they make different things, or equal ones.
  OfferRange search(OfferSum of, double goal, double undo) {
    begin(of, low_, high_, std::sqrt(low_) * std::sqrt(high_));
    auto* const range = range_.data();
    double width = std::log(high_) - std::log(low_);
    for (Index open = 2; open > 1 && width > resolution_;) {
      for (int k = 0; k < at_once_; ++k) {
        add_sums(undo);
        backend_.for_each(1, HalveRange{range, of, goal});
        width /= 2;
      }
      each([&](std::size_t type, auto& own) {
        own.settle({&range->low, undo}, {&range->high, undo}, &range->settled,
                   counts_.data() + type);
      });
      auto const counts = download<Index>(counts_);
      open = 0;
      each([&](std::size_t type, auto& own) {
        own.leave_open(counts[type]);
        open += counts[type];
      });
    }
    return download<OfferRange>(range_)[0];
  }

  B const& backend_;
  std::vector<std::unique_ptr<OffersOfType>> const& all_;
  double release_;
  double low_ = 0, high_ = 0;  // J per evaluation
  typename B::template Array<OfferRange> range_;
  typename B::template Array<Index> counts_;  // (types)
};

}  // namespace pliant::detail

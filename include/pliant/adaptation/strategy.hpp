#pragma once

#include <pliant/adaptation/criterion/condition.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/refinement_results.hpp>

// Strategies read as sentences:
//   when<Linear>(largest(EdgeLengthRatio{}, Rotation{})).above(0.1).become<Nonlinear>()
//   when<Linear>(ForceIntensity<>{}).above_fraction_of_largest(0.9).refine({.max_level = 6})
//   when<Linear>(RecoveredStress{}).bulk(0.5).refine({.max_level = 6})
//   when<Linear>(all(VonMises{} > 1e5, Rotation{} < 0.1)).holds().become<Nonlinear>()
//   when<Linear>(RecoveredStress{}).below(1e-6).coarsen()
//   when<Linear>(RecoveredStress{}).bulk(0.5).raise({.ring = 1})
//   when<Quadratic>(RecoveredStress{}).below(1e-6).lower()
//   sleep({.below = 1e-3, .for_steps = 64})
namespace pliant {

namespace detail {
inline double number(char const* what, double value) {
  if (std::isnan(value))
    throw Error("strategy: ", what, "(NaN) is not a number to compare with; give one");
  return value;
}
}  // namespace detail

/// A criterion with a marking, of which a rule is made.
template <class From, class C>
class Marked {
 public:
  Marked(C criterion, Marking marking) : criterion_(criterion), marking_(marking) {}

  /// No element with a smaller value acts, whatever the others have.
  Marked floor(double value) const {
    if (marking_.below())
      throw Error(
          "strategy: a rule with below has no floor; give a floor to rules that look for "
          "large values");
    Marked m = *this;
    m.marking_.floor = detail::number("floor", value);
    return m;
  }
  /// At most so many elements act in one check: those of the most extreme values.
  Marked budget(long elements) const {
    if (elements < 1)
      throw Error("strategy: a budget of ", elements,
                  " elements allows no action; give at least 1");
    Marked m = *this;
    m.marking_.budget = elements;
    return m;
  }
  /// An element acts only after so many steps in its group.
  Marked stay(long steps) const {
    if (steps < 0) throw Error("strategy: a stay of ", steps, " steps; give at least 0");
    Marked m = *this;
    m.stay_ = steps;
    return m;
  }

  template <class To>
  auto become() const {
    static_assert(std::same_as<typename From::element, typename To::element>,
                  "become<To>: From and To must be formulations on the same element");
    return SwitchRule<From, To, C>{criterion_, marking_, stay_};
  }
  auto refine(RefineOptions options = {}) const {
    static_assert(Refinable<typename From::element>,
                  "refine: available for the catalogue's elements");
    check_no_stay("refine");
    detail::check_max_level("strategy", options.max_level);
    return RefineRule<From, C>{criterion_, marking_, options};
  }
  /// See CoarsenRule. An element that another rule refines in the same look is not merged.
  auto coarsen(CoarsenOptions options = {}) const {
    static_assert(Refinable<typename From::element>,
                  "coarsen: available for the catalogue's elements");
    check_no_stay("coarsen");
    if (options.min_level < 0)
      throw Error("strategy: a min_level of ", options.min_level, "; give at least 0");
    return CoarsenRule<From, C>{criterion_, marking_, options};
  }
  /// See raise. Of elements that another rule refines in the same look, these are divided.
  auto raise(RaiseOptions options = {}) const {
    static_assert(From::element::degree == 1 && Refinable<typename From::element>,
                  "raise: for linear elements of the catalogue");
    check_no_stay("raise");
    if (options.ring < 0)
      throw Error("strategy: a ring of ", options.ring, "; give the number of rings, 0 or more");
    return RaiseRule<From, C>{criterion_, marking_, options};
  }
  /// See lower. Elements that another rule refines in the same look keep their degree.
  auto lower() const {
    static_assert(From::element::degree == 2, "lower: for quadratic elements");
    check_no_stay("lower");
    return LowerRule<From, C>{criterion_, marking_};
  }
  /// See split. Elements that another rule refines or raises in the same look are not split.
  auto split(SplitOptions options = {}) const {
    static_assert(!std::is_void_v<SplitInto<typename From::element>>,
                  "split: for Quad4, Hex8 and Pyramid5 elements");
    check_no_stay("split");
    if (options.triangles != 2 && options.triangles != 4)
      throw Error("strategy: a split into ", options.triangles, " triangles; give 2 or 4");
    return SplitRule<From, C>{criterion_, marking_, options};
  }
  /// See merge. Elements that another rule refines, raises or splits in the same look are not merged.
  auto merge() const {
    static_assert(is_part<typename From::element>,
                  "merge: for Tri3, Pyramid5 and Tet4 elements, into which others are split");
    check_no_stay("merge");
    return MergeRule<From, C>{criterion_, marking_};
  }

 private:
  void check_no_stay(char const* action) const {
    if (stay_ != 0)
      throw Error("strategy: ", action, " has no stay; use stay with become, or check less often");
  }

  C criterion_;
  Marking marking_;
  long stay_ = 0;
};

/// A criterion, looked at for the elements of one formulation.
template <class From, class C>
class When {
 public:
  explicit When(C criterion) : criterion_(criterion) {}

  auto above(double value) const {
    return marked(MarkingKind::above, detail::number("above", value));
  }
  auto below(double value) const {
    return marked(MarkingKind::below, detail::number("below", value));
  }
  auto above_fraction_of_largest(double fraction) const {
    return marked(MarkingKind::fraction_of_largest, checked(fraction));
  }
  auto top_share(double share) const { return marked(MarkingKind::top_share, checked(share)); }
  auto bulk(double share) const { return marked(MarkingKind::bulk, checked(share)); }
  /// Of conditions: where it holds.
  auto holds() const
    requires ElementCondition<C>
  {
    return marked(MarkingKind::above, 0.5);
  }

 private:
  Marked<From, C> marked(MarkingKind kind, double amount) const {
    return {criterion_, {kind, amount}};
  }
  static double checked(double share) {
    if (!(share >= 0 && share <= 1))
      throw Error("strategy: ", share, " is not a share; give a number in [0, 1]");
    return share;
  }
  C criterion_;
};

/// Lets patches sleep while they are at rest; see SleepRule. An Adaptation has at most one. Throws Error for a
/// speed that is not positive, and for fewer steps than one.
inline SleepRule sleep(SleepOptions const& options) {
  if (!(options.below > 0) || !std::isfinite(options.below))
    throw Error("sleep: below is ", options.below, " m/s; give a positive speed");
  if (options.for_steps < 1 || options.for_steps > std::numeric_limits<std::int32_t>::max() / 2)
    throw Error("sleep: for_steps is ", options.for_steps,
                "; give at least 1, and 10⁹ at the most");
  return {options.below, options.for_steps};
}

template <class From, class C>
When<From, C> when(C criterion) {
  static_assert(Criterion<C, From>,
                "when<F>(criterion): a criterion is called with the state of an element of F, and "
                "gives a number");
  return When<From, C>{criterion};
}

}  // namespace pliant

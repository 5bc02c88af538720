#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/adaptation/marking.hpp>

namespace pliant {

/// Elements of From that a criterion marks change to the group To.
template <class From, class To, class C>
struct SwitchRule {
  using from = From;
  using to = To;
  C criterion;
  Marking marking;
  std::int64_t stay;  // steps that an element stays in a group at the least
};

struct RefineOptions {
  int max_level = 30;  // elements refined this often are left alone; at most most_levels
};

/// Elements of From that a criterion marks are divided into four, solid ones into eight.
template <class From, class C>
struct RefineRule {
  using from = From;
  C criterion;
  Marking marking;
  RefineOptions options;
};

struct CoarsenOptions {
  int min_level = 0;  // elements refined no more often than this are left alone
};

/// Families of elements of From (or of the groups of other such rules) all of which a criterion marks are merged, where
/// no neighbour is too fine.
template <class From, class C>
struct CoarsenRule {
  using from = From;
  C criterion;
  Marking marking;
  CoarsenOptions options;
};

struct RaiseOptions {
  int ring = 0;  // so many rings of neighbours, across edges, are raised along
};

/// Linear elements of From that a criterion marks become quadratic, as by raise.
template <class From, class C>
struct RaiseRule {
  using from = From;
  C criterion;
  Marking marking;
  RaiseOptions options;
};

/// Quadratic elements of From that a criterion marks become linear, as by lower.
template <class From, class C>
struct LowerRule {
  using from = From;
  static constexpr bool lowers = true;
  C criterion;
  Marking marking;
};

struct SplitOptions {
  int triangles = 4;  // into which quadrilaterals are split: two or four
};

/// Elements of From that a criterion marks give way to such of another shape, as by split.
template <class From, class C>
struct SplitRule {
  using from = From;
  C criterion;
  Marking marking;
  SplitOptions options;
};

/// Elements of From all of which, of one that was split into them, a criterion marks are merged, as by merge.
template <class From, class C>
struct MergeRule {
  using from = From;
  static constexpr bool merges = true;
  C criterion;
  Marking marking;
};

struct SleepOptions {
  double below;  // m/s
  std::int64_t for_steps = 64;
};

/// Patches whose nodes have been slower than `below` for so many steps, and which nothing pulls at that would give
/// them that speed in as many, sleep until something would, or until nobody has looked for as many.
struct SleepRule {
  double below;
  std::int64_t for_steps;
};

namespace detail {
template <class R>
concept MarksElements = requires(R const& rule) {
  typename R::from;
  rule.criterion;
  { rule.marking } -> std::convertible_to<Marking>;
} && Criterion<decltype(R::criterion), typename R::from>;
}  // namespace detail

/// What an Adaptation takes: marks elements of one formulation by a criterion, and says what becomes
/// of them. `when` makes rules.
template <class R>
concept SwitchingRule = detail::MarksElements<R> && requires(R const& rule) {
  typename R::to;
  { rule.stay } -> std::convertible_to<std::int64_t>;
};
template <class R>
concept RefiningRule = detail::MarksElements<R> && requires(R const& rule) {
  { rule.options.max_level } -> std::convertible_to<int>;
};
template <class R>
concept CoarseningRule = detail::MarksElements<R> && requires(R const& rule) {
  { rule.options.min_level } -> std::convertible_to<int>;
};
template <class R>
concept RaisingRule = detail::MarksElements<R> && requires(R const& rule) {
  { rule.options.ring } -> std::convertible_to<int>;
};
template <class R>
concept LoweringRule = detail::MarksElements<R> && R::lowers;
template <class R>
concept SplittingRule = detail::MarksElements<R> && requires(R const& rule) {
  { rule.options.triangles } -> std::convertible_to<int>;
};
template <class R>
concept MergingRule = detail::MarksElements<R> && R::merges;
/// Changes the mesh.
template <class R>
concept MeshRule = RefiningRule<R> || CoarseningRule<R> || RaisingRule<R> || LoweringRule<R> ||
                   SplittingRule<R> || MergingRule<R>;
/// Puts patches to sleep that are at rest, whatever their formulation; `sleep` makes one.
template <class R>
concept SleepingRule = requires(R const& rule) {
  { rule.below } -> std::convertible_to<double>;
  { rule.for_steps } -> std::convertible_to<std::int64_t>;
};
/// Chooses a group for each element of several; `cheapest` and `within` make them.
template <class R>
concept ChoosingRule = requires(R const& rule) {
  typename R::groups;
  typename R::element;
  { rule.limits_sums() } -> std::same_as<bool>;
};
/// Refines and merges elements so that limits hold; `within` with an estimator makes one.
template <class R>
concept HoldingRule = R::holds_mesh && requires(R const& rule) {
  typename R::from;
  rule.estimator;
};
/// One that moves them between several groups too.
template <class R>
concept HoldsGroups = HoldingRule<R> && R::holds_groups;
template <class R>
concept Rule =
    SwitchingRule<R> || MeshRule<R> || SleepingRule<R> || ChoosingRule<R> || HoldingRule<R>;

}  // namespace pliant

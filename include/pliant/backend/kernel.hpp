#pragma once

#include <concepts>
#include <utility>

#include <pliant/backend/dispatch.hpp>
#include <pliant/backend/field.hpp>

// What verbs over elements ask of the functors they are given. S is the scalar of the element loop, T
// the plain one, V are the values of the fields at the nodes of an element, Matrix<S, Nodes,
// Components>, and Own gives values per element.
namespace pliant {

namespace detail {

template <class F, class Result, class Own, class Group, class... V>
concept GivesAt = (ReadsElements<F> && requires(F const& f, Own const& own, V const&... v) {
                    { f(Group{}, own, v...) } -> std::convertible_to<Result>;
                  }) || (!ReadsElements<F> && requires(F const& f, V const&... v) {
                    { f(Group{}, v...) } -> std::convertible_to<Result>;
                  });

template <class T, class Evaluated>
struct PlainValues {};
template <class T, class S, int N>
struct PlainValues<T, Vector<S, N>> {
  using type = Vector<T, N>;
};

struct TallyProbe {
  PLIANT_HOST_DEVICE void operator()(int, double) const {}
};
template <class F, class Group, class Values, class Again>
concept FinishesAt = requires(F const& f, Index e, Values const& values, Again const& again,
                              TallyProbe tally) { f.finish(Group{}, e, values, again, tally); };
template <class F, class T, class Again, class Group, class Evaluated>
concept FinishesEvaluated =
    FinishesAt<F, Group, typename PlainValues<T, std::remove_cvref_t<Evaluated>>::type, Again>;

template <class F, class T, class Own, class Again, class Group, class... V>
concept VisitsAt =
    (ReadsElements<F> && requires(F const& f, Own const& own, V const&... v) {
      requires FinishesEvaluated<F, T, Again, Group, decltype(f.evaluate(Group{}, own, v...))>;
    }) || (!ReadsElements<F> && requires(F const& f, V const&... v) {
      requires FinishesEvaluated<F, T, Again, Group, decltype(f.evaluate(Group{}, v...))>;
    });

template <class F, class Result, class Own, class... V, int... G>
constexpr bool gives_at_each(std::integer_sequence<int, G...>) {
  return (GivesAt<F, Result, Own, GroupNumber<G>, V...> && ...);
}
template <class F, class T, class Own, class Again, class... V, int... G>
constexpr bool visits_each(std::integer_sequence<int, G...>) {
  return (VisitsAt<F, T, Own, Again, GroupNumber<G>, V...> && ...);
}

}  // namespace detail

/// Gives a Result for elements of each of the groups 0, 1, ... Groups − 1.
template <class F, class Result, int Groups, class Own, class... V>
concept Kernel =
    detail::gives_at_each<F, Result, Own, V...>(std::make_integer_sequence<int, Groups>());

/// Visits elements of each of the groups; `Again` gives their V... as plain numbers.
template <class F, class T, class Again, int Groups, class Own, class... V>
concept Visitor = requires {
  { F::counters } -> std::convertible_to<int>;
} && detail::visits_each<F, T, Own, Again, V...>(std::make_integer_sequence<int, Groups>());

/// A kernel of accumulate whose shares add up to zero and depend on how far its fields differ from node to node alone,
/// and that knows no first node: given an element's nodes in another order of the same orientation, it gives each of
/// them what it gave it before. A backend may use all of it.
template <class F>
concept SymmetricKernel = requires { requires F::symmetric; };

/// A visitor, or a kernel to accumulate, that tells which elements it has nothing to do with: bool selects(Index element, Tag
/// group) const. A backend may pass those over.
template <class F>
concept Selects = requires(F const& f, Index element, Tag group) {
  { f.selects(element, group) } -> std::same_as<bool>;
};

/// A visitor whose `finish` has work with few elements: what that takes should not slow `evaluate`, which all go through.
template <class F>
concept FinishesFew = requires { requires F::finishes_few; };

/// Verbs call these first, so that a functor which lacks a part is told by a sentence.
template <class F, class Result, int Groups, class Own, class... V>
constexpr void require_kernel() {
  static_assert(
      Kernel<F, Result, Groups, Own, V...>,
      "a kernel has operator()(GroupNumber<g>, V const&... v) const for each group g, where v "
      "are the values of the fields at an element's nodes, Matrix<S, Nodes, Components>, "
      "with an argument `own` before them if it has reads_elements = true; for accumulate "
      "it returns a Matrix<S, Nodes, Components>, for sum_elements an S "
      "(backend/backend.hpp)");
}
template <class F, class T, class Again, int Groups, class Own, class... V>
constexpr void require_visitor() {
  static_assert(
      Visitor<F, T, Again, Groups, Own, V...>,
      "a visitor has `static constexpr int counters`, evaluate(GroupNumber<g>, V const&... v) "
      "const, which returns a Vector<S, N>, and finish(GroupNumber<g>, Index element, "
      "Vector<T, N> const&, again, tally) const, for each group g (backend/backend.hpp)");
}

}  // namespace pliant

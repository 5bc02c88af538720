#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <type_traits>

#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/force_costs.hpp>
#include <pliant/adaptation/mesh_offers.hpp>
#include <pliant/adaptation/refinement.hpp>

// A mesh that is as fine as an error asks, or as a budget allows, wherever that is needed at the time.
namespace pliant {

struct MeshWithinOptions {
  static constexpr double none = std::numeric_limits<double>::infinity();

  double error = none;                 // J: the sum of what is estimated of the elements
  double evaluations_per_step = none;  // in forces of one element of the first formulation
  double milliseconds_per_step =
      none;  // measured from look to look, with all that a caller does between them
  double release =
      0.5;  // what is there is taken to be worth 1/release times as much where it is as elsewhere
  int max_level = 30;           // elements refined this often are left alone
  double (*clock)() = nullptr;  // s; null: the machine's
};

/// Elements of the formulations Fs are refined and merged, raised and lowered as an estimator and limits ask; see within.
template <class E, class... Fs>
struct MeshWithinRule {
  using from = std::tuple_element_t<0, std::tuple<Fs...>>;
  using formulations = detail::TypeList<Fs...>;
  static constexpr bool holds_mesh = true;
  E estimator;
  MeshWithinOptions options;
};

namespace detail {
inline void check_limits(MeshWithinOptions const& options) {
  for (double limit : {options.error, options.evaluations_per_step, options.milliseconds_per_step})
    if (!(limit > 0)) throw Error("within: a limit is ", limit, "; give a positive number");
  if (!std::isfinite(options.error) && !std::isfinite(options.evaluations_per_step) &&
      !std::isfinite(options.milliseconds_per_step))
    throw Error(
        "within: there is no limit; give error, evaluations_per_step or milliseconds_per_step");
  if (!(options.release > 0 && options.release <= 1))
    throw Error("within: release is ", options.release, "; give a share above 0, 1 at the most");
  if (options.max_level < 0)
    throw Error("within: max_level is ", options.max_level, "; give at least 0");
}
}  // namespace detail

/// Refines the elements of F whose estimated error drops most per cost and merges the families whose error rises least per
/// cost saved, at each look anew: as few elements as keep what is estimated at most `error`, and never more than
/// `evaluations_per_step` or what `milliseconds_per_step` allow, which come first. Errors of smooth solutions are taken to fall
/// by 4^degree where an element is refined; at singular places that takes more looks. Towards an error a look makes no more
/// than leaves a quarter of what there is, and undoes only what is not wanted in the end. To keep levels within one, neighbours
/// are refined along, beyond the budget until the next look merges others. Throws Error for options out of range.
template <class F, class E>
auto within(E estimator, MeshWithinOptions const& options) {
  static_assert(Estimator<E, F>, "within<F>(estimator, ...): an estimator of elements of F");
  detail::check_limits(options);
  return MeshWithinRule<E, F>{estimator, options};
}
/// The same with degrees: linear elements of F are refined or become quadratic ones of Higher, on the same cell, and these are
/// refined, merged or lowered: each takes the first step to the degree and the size for which its error and its cost, at the
/// price that keeps the limits, are least. Raising is taken to make an error 16 times smaller, as one refinement of a quadratic
/// element does.
template <class F, class Higher, class E>
auto within(E estimator, MeshWithinOptions const& options) {
  static_assert(Estimator<E, F> && Estimator<E, Higher>,
                "within<F, Higher>(estimator, ...): an estimator of elements of both");
  static_assert(F::element::degree == 1 && Higher::element::degree == 2 &&
                    std::same_as<typename F::element::cell, typename Higher::element::cell>,
                "within<F, Higher>: F is on linear elements, Higher on quadratic ones of the same "
                "cell");
  detail::check_limits(options);
  return MeshWithinRule<E, F, Higher>{estimator, options};
}

namespace detail {

/// The elements of a type by their parents, where all children of one are such.
template <Element E, class Parts>
std::vector<std::vector<Index>> families_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  std::vector<std::vector<Index>> families;
  if (!topology.tree) return families;
  std::map<Index, std::vector<Index>> by_parent;
  auto const& cells = topology.cells[Parts::layout_type::template type_of<E>];
  for (std::size_t e = 0; e < cells.size(); ++e)
    if (Index const parent = topology.tree->cell(cells[e]).parent; parent >= 0)
      by_parent[parent].push_back(static_cast<Index>(e));
  for (auto& [parent, children] : by_parent)
    if (children.size() == static_cast<std::size_t>(topology.tree->cell(parent).divided().children))
      families.push_back(std::move(children));
  return families;
}

/// What one element of each formulation costs, in those of the first; counted operations, the same on all machines.
template <class Parts, class... Fs>
std::array<double, sizeof...(Fs)> costs_beside_first(Parts const& parts, TypeList<Fs...> list) {
  if constexpr (sizeof...(Fs) == 1) return {1};
  auto costs = counted_costs(parts, list);
  double const first = costs[0];
  for (double& cost : costs) cost /= first;
  return costs;
}

/// How many evaluations a step takes, in forces of one element of the first formulation.
template <class Parts, class E, class... Fs>
double evaluations_of_mesh(Parts const& parts, MeshWithinRule<E, Fs...> const&) {
  auto const costs = costs_beside_first(parts, TypeList<Fs...>{});
  double sum = 0;
  std::size_t k = 0;
  ((sum +=
    costs[k++] * static_cast<double>(
                     parts.state.topology->mesh.template elements<typename Fs::element>().size())),
   ...);
  return sum;
}

/// One look of a rule that holds a mesh within limits, of which `evaluations` is the budget; NaN: not known yet.
template <DeformableBody TheBody, class Estimate, class... Fs>
void hold_mesh(TheBody& body, MeshWithinRule<Estimate, Fs...> const& rule, double evaluations) {
  auto& parts = body.parts();
  using Parts = std::remove_cvref_t<decltype(parts)>;
  if (std::isnan(evaluations)) return;
  auto const costs = costs_beside_first(std::as_const(parts), TypeList<Fs...>{});
  constexpr std::size_t count = sizeof...(Fs);
  std::array<MeshOffers::Kinds, count> kinds;
  std::array<std::vector<std::vector<Index>>, count> families;
  std::array<std::size_t, count> first{}, counts{};  // offers of elements
  MeshOffers offers(rule.options.release);
  std::size_t k = 0;
  auto const describe = [&]<class F>(TypeList<F>) {
    using E = typename F::element;
    kinds[k].own = {std::pow(0.25, E::degree), E::dim == 2 ? 4 : 8, costs[k]};
    if (k + 1 < count) kinds[k].higher = &kinds[k + 1].own;
    if (k > 0) kinds[k].lower = &kinds[k - 1].own;
    ++k;
  };
  (describe(TypeList<Fs>{}), ...);
  k = 0;
  auto const add = [&]<class F>(TypeList<F>) {
    using E = typename F::element;
    auto const errors = evaluate<E>(body, rule.estimator);
    auto const levels = levels_of<E>(parts);
    counts[k] = errors.size();
    for (std::size_t e = 0; e < errors.size(); ++e) {
      auto const offer = offers.add_element(std::isfinite(errors[e]) ? errors[e] : 0, kinds[k],
                                            std::max(0, rule.options.max_level - levels[e]));
      if (e == 0) first[k] = offer;
    }
    families[k] = families_of<E>(std::as_const(parts));
    for (auto const& family : families[k]) {
      std::vector<std::size_t> members;
      for (Index e : family) members.push_back(first[k] + static_cast<std::size_t>(e));
      offers.add_family(members);
    }
    ++k;
  };
  (add(TypeList<Fs>{}), ...);
  auto const limits = offers.limits_for(rule.options.error, evaluations);

  MarkedElements marked;
  auto const types = element_counts(parts.state.topology->mesh).size();
  for (auto* list : {&marked.refine, &marked.coarsen, &marked.raise, &marked.lower})
    list->resize(types);
  std::size_t family = 0;
  k = 0;
  auto const mark = [&](std::size_t type) {
    for (std::size_t e = 0; e < counts[k]; ++e) {
      auto const action = offers.action(first[k] + e, limits);
      for (auto const& [list, wanted] : {std::pair{&marked.refine, MeshOffers::Action::divide},
                                         {&marked.raise, MeshOffers::Action::raise},
                                         {&marked.lower, MeshOffers::Action::lower}})
        if (action == wanted) (*list)[type].push_back(static_cast<Index>(e));
    }
    for (auto const& members : families[k])
      if (offers.merges(family++, limits))
        marked.coarsen[type].insert(marked.coarsen[type].end(), members.begin(), members.end());
    ++k;
  };
  (mark(Parts::layout_type::template type_of<typename Fs::element>), ...);
  if (marked.none()) return;
  auto const plan = plan_change(parts, marked, rule.options.max_level);
  if (!plan) return;
  commit(parts, *plan);
  tell_listeners(parts, *plan);
}

}  // namespace detail
}  // namespace pliant

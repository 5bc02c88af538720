#pragma once

#include <cmath>
#include <limits>
#include <map>

#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/refinement.hpp>

// A mesh that is as fine as an error asks, or as a budget allows, wherever that is needed at the time.
namespace pliant {

struct MeshWithinOptions {
  static constexpr double none = std::numeric_limits<double>::infinity();

  double error = none;                 // J: the sum of what is estimated of the elements
  double evaluations_per_step = none;  // in forces of one element: how many elements there are
  double release =
      0.5;  // families are taken to be worth 1/release times as much where they are as elsewhere
  int max_level = 30;  // elements refined this often are left alone
};

/// Elements of F are refined and merged as an estimator and limits ask; see within.
template <class F, class E>
struct MeshWithinRule {
  using from = F;
  static constexpr bool holds_mesh = true;
  E estimator;
  MeshWithinOptions options;
};

/// Refines the elements of F whose estimated error drops most per cost and merges the families whose error rises least per
/// cost saved, at each look anew: as few elements as keep what is estimated at most `error`, and never more than
/// `evaluations_per_step`, which comes first. Errors of smooth solutions are taken to fall by 4^degree where an element is
/// refined; at singular places that takes more looks. A look aims at half of the error at the least. To keep levels within one, neighbours are refined along, beyond
/// the budget until the next look merges others. Throws Error for options out of range.
template <class F, class E>
auto within(E estimator, MeshWithinOptions const& options) {
  static_assert(Estimator<E, F>, "within<F>(estimator, ...): an estimator of elements of F");
  for (double limit : {options.error, options.evaluations_per_step})
    if (!(limit > 0)) throw Error("within: a limit is ", limit, "; give a positive number");
  if (!std::isfinite(std::min(options.error, options.evaluations_per_step)))
    throw Error("within: there is no limit; give error or evaluations_per_step");
  if (!(options.release > 0 && options.release <= 1))
    throw Error("within: release is ", options.release, "; give a share above 0, 1 at the most");
  if (options.max_level < 0)
    throw Error("within: max_level is ", options.max_level, "; give at least 0");
  return MeshWithinRule<F, E>{estimator, options};
}

namespace detail {

/// What changes of a mesh are worth: those worth more than a limit are made, and undone those worth less.
class MeshOffers {
 public:
  MeshOffers(double drop, double release) : drop_(drop), release_(release) {}

  /// An element that may be divided into so many, or not.
  void add_element(double error, int children, bool may_divide) {
    elements_.push_back({error, may_divide ? error * (1 - drop_) / (children - 1) : 0,
                         static_cast<double>(children - 1)});
    error_ += error;
  }
  void add_family(double error, int children) {
    families_.push_back(
        {error, error * (1 / drop_ - 1) / (children - 1), static_cast<double>(children - 1)});
  }

  bool divides(std::size_t element, double limit) const { return elements_[element].worth > limit; }
  bool merges(std::size_t family, double limit) const {
    return families_[family].worth < release_ * limit;
  }

  struct Outcome {
    double error, evaluations;
  };
  Outcome at(double limit) const {
    Outcome found{error_, static_cast<double>(elements_.size())};
    for (auto const& own : elements_) {
      if (!(own.worth > limit)) continue;
      found.error -= own.error * (1 - drop_);
      found.evaluations += own.evaluations;
    }
    for (auto const& own : families_) {
      if (!(own.worth < release_ * limit)) continue;
      found.error += own.error * (1 / drop_ - 1);
      found.evaluations -= own.evaluations;
    }
    return found;
  }
  /// The largest limit that keeps the error, or the least that keeps the budget where that is larger.
  double limit_for(MeshWithinOptions const& options) const {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    auto const widen = [&](auto const& own) {
      if (!(own.worth > 0)) return;
      least = std::min(least, own.worth);
      most = std::max(most, own.worth);
    };
    for (auto const& own : elements_) widen(own);
    for (auto const& own : families_) widen(own);
    if (most == 0) return 1;  // nothing is wrong anywhere: all merges
    double const low = least / 2, high = 2 * most / release_;
    auto const search = [&](auto const& is_low) {
      double a = low, b = high;
      for (int k = 0; k < 60; ++k) {
        double const middle = std::sqrt(a * b);
        (is_low(at(middle)) ? a : b) = middle;
      }
      return std::pair{a, b};
    };
    double limit = high;
    // Not all at once: what is left after half of the error is best known then.
    double const aim = std::max(options.error, error_ / 2);
    if (std::isfinite(options.error))
      limit = search([&](Outcome const& o) { return o.error <= aim; }).first;
    else
      limit = low;
    if (at(limit).evaluations > options.evaluations_per_step)
      limit = search([&](Outcome const& o) {
                return o.evaluations > options.evaluations_per_step;
              }).second;
    return limit;
  }

 private:
  struct Offer {
    double error, worth, evaluations;  // J, J per evaluation
  };
  double drop_, release_, error_ = 0;
  std::vector<Offer> elements_, families_;
};

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

/// One look of a rule that holds a mesh within limits.
template <DeformableBody TheBody, class TheRule>
void hold_mesh(TheBody& body, TheRule const& rule) {
  using E = typename TheRule::from::element;
  auto& parts = body.parts();
  using Parts = std::remove_cvref_t<decltype(parts)>;
  constexpr std::size_t type = Parts::layout_type::template type_of<E>;
  constexpr int children = E::dim == 2 ? 4 : 8;
  auto errors = evaluate<E>(body, rule.estimator);
  for (double& error : errors)
    if (!std::isfinite(error)) error = 0;
  auto const levels = levels_of<E>(parts);
  auto const families = families_of<E>(std::as_const(parts));
  MeshOffers offers(std::pow(0.25, E::degree), rule.options.release);
  for (std::size_t e = 0; e < errors.size(); ++e)
    offers.add_element(errors[e], children, levels[e] < rule.options.max_level);
  for (auto const& family : families) {
    double sum = 0;
    for (Index e : family) sum += errors[static_cast<std::size_t>(e)];
    offers.add_family(sum, static_cast<int>(family.size()));
  }
  double const limit = offers.limit_for(rule.options);
  MarkedElements marked;
  auto const types = element_counts(parts.state.topology->mesh).size();
  marked.refine.resize(types);
  marked.coarsen.resize(types);
  for (std::size_t e = 0; e < errors.size(); ++e)
    if (offers.divides(e, limit)) marked.refine[type].push_back(static_cast<Index>(e));
  for (std::size_t k = 0; k < families.size(); ++k)
    if (offers.merges(k, limit))
      marked.coarsen[type].insert(marked.coarsen[type].end(), families[k].begin(),
                                  families[k].end());
  if (marked.none()) return;
  auto const plan = plan_change(parts, marked, rule.options.max_level);
  if (!plan) return;
  commit(parts, *plan);
  tell_listeners(parts, *plan);
}

}  // namespace detail
}  // namespace pliant

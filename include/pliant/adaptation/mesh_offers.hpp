#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace pliant::detail {

/// What changes of a mesh, and of the groups of its elements, are worth, in joules per evaluation: those worth more than one
/// limit are made, and undone where they are those worth less than another.
class MeshOffers {
 public:
  /// Elements of one degree that are alike: what a division makes of one.
  struct Kind {
    double factor;  // of the error
    int children;
    double evaluations;  // of one element
  };
  /// Elements of a kind in one group, and those of a higher or a lower degree on the same cell.
  struct Kinds {
    Kind own;
    Kind const *higher = nullptr, *lower = nullptr;
  };
  /// What raising makes of an error, and lowering: more than that undoes, since smooth solutions lose more, and elements
  /// that go back and forth cost more than a few that are raised too long.
  static constexpr double raising = 1.0 / 16, lowering = 64;

  /// `release`: what is there is taken to be worth 1/release times as much as what is not.
  explicit MeshOffers(double release) : release_(release) {}

  /// An element that may be divided so often and keeps its group. Returns its number.
  std::size_t add_element(double error, Kinds const& kinds, int divisions) {
    constexpr double nothing = 0;
    return add_element(error, {&kinds, 1}, 0, {&nothing, 1}, divisions);
  }
  /// One in a group of several to which it may go, each costlier than the one before. `of_groups`: what each gets wrong
  /// whatever the mesh, J.
  std::size_t add_element(double error, std::span<Kinds const> groups, std::size_t group,
                          std::span<double const> of_groups, int divisions) {
    elements_.push_back({error, groups.data(), groups.size(), group, of_groups_.size(), divisions});
    of_groups_.insert(of_groups_.end(), of_groups.begin(), of_groups.end());
    error_ += error + of_group(elements_.back(), group);
    evaluations_ += groups[group].own.evaluations;
    return elements_.size() - 1;
  }
  /// Elements, by these numbers, that may be merged. Returns the family's number.
  std::size_t add_family(std::vector<std::size_t> const& members) {
    double sum = 0, evaluations = 0;
    for (std::size_t e : members) {
      auto& own = elements_[e];
      own.family = families_.size();
      sum += own.error;
      evaluations += own.kinds[own.group].own.evaluations;
    }
    Kind const& kind = elements_[members.front()].kinds->own;
    families_.push_back(
        {sum, {1 / kind.factor, (1 / static_cast<double>(members.size()) - 1) * evaluations}});
    return families_.size() - 1;
  }

  struct Limits {
    double make, undo;  // J per evaluation
  };
  enum class Action { none, divide, raise, lower };
  Action action(std::size_t e, Limits const& limits) const { return action(elements_[e], limits); }
  std::size_t group(std::size_t e, Limits const& limits) const {
    return group(elements_[e], limits);
  }
  bool merges(std::size_t family, Limits const& limits) const {
    auto const& own = families_[family];
    return own.merged.is_there() && worth(own.error, own.merged) < release_ * limits.undo;
  }

  struct Outcome {
    double error, evaluations;
  };
  Outcome at(Limits const& limits) const {
    Outcome found{error_, evaluations_};
    auto const make = [&](double error, Change const& change) {
      found.error += error * (change.factor - 1);
      found.evaluations += change.evaluations;
    };
    for (auto const& own : elements_) {
      if (auto const to = group(own, limits); to != own.group) {
        found.error += of_group(own, to) - of_group(own, own.group);
        found.evaluations += own.evaluations(to) - own.evaluations(own.group);
      }
      if (auto const chosen = action(own, limits); chosen != Action::none)
        make(own.error, change(own, group(own, limits), chosen));
    }
    for (std::size_t k = 0; k < families_.size(); ++k)
      if (merges(k, limits)) make(families_[k].error, families_[k].merged);
    return found;
  }
  /// The largest limits that keep what is left of the error, or the least that keep the budget where these are larger;
  /// infinite: there is none. Towards an error no more is made than leaves a quarter of what there is: the rest is best known
  /// then. Undone is what neither asks for in the end.
  Limits limits_for(double error, double evaluations) const {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    auto const widen = [&](double own) {
      if (!(own > 0)) return;
      least = std::min(least, own);
      most = std::max(most, own);
    };
    for (auto const& own : elements_) {
      for (std::size_t k = 0; k < own.groups; ++k) {
        for (Action each : {Action::divide, Action::raise, Action::lower})
          widen(worth(own.error, change(own, k, each)));
        for (std::size_t j = 0; j < k; ++j)
          widen((of_group(own, j) - of_group(own, k)) / (own.evaluations(k) - own.evaluations(j)));
      }
    }
    for (auto const& own : families_) widen(worth(own.error, own.merged));
    if (most == 0) return {1, 1};  // nothing is wrong anywhere: all is undone
    double const low = least / 2, high = 2 * most / release_;
    auto const search = [&](auto const& is_low) {
      double a = low, b = high;
      for (int k = 0; k < 60; ++k) {
        double const middle = std::sqrt(a * b);
        (is_low(middle) ? a : b) = middle;
      }
      return std::pair{a, b};
    };
    bool const has_error = std::isfinite(error);
    double const end = has_error ? search([&](double l) {
                                     return at({l, l}).error <= error;
                                   }).first
                                 : low;
    if (at({end, end}).evaluations > evaluations) {
      double const limit = search([&](double l) {
                             return at({l, l}).evaluations > evaluations;
                           }).second;
      return {limit, limit};
    }
    if (!has_error || error >= error_ / 4) return {end, end};
    return {search([&](double l) { return at({l, end}).error <= error_ / 4; }).first, end};
  }

 private:
  static constexpr auto no_family = static_cast<std::size_t>(-1);
  /// By which factor an error changes, and by how much the evaluations; nothing where they do not.
  struct Change {
    double factor = 1, evaluations = 0;
    bool is_there() const { return evaluations != 0; }
  };
  struct Element {
    double error;        // J
    Kinds const* kinds;  // (groups)
    std::size_t groups, group, first_of_groups;
    int divisions;
    std::size_t family = no_family;

    double evaluations(std::size_t in_group) const { return kinds[in_group].own.evaluations; }
  };
  struct Family {
    double error;  // J
    Change merged;
  };

  static Change change(Element const& own, std::size_t group, Action action) {
    auto const& [kind, higher, lower] = own.kinds[group];
    if (action == Action::divide && own.divisions > 0)
      return {kind.factor, (kind.children - 1) * kind.evaluations};
    if (action == Action::raise && higher != nullptr)
      return {raising, higher->evaluations - kind.evaluations};
    if (action == Action::lower && lower != nullptr)
      return {lowering, lower->evaluations - kind.evaluations};
    return {};
  }
  /// J per evaluation.
  static double worth(double error, Change const& change) {
    return change.is_there() ? error * (1 - change.factor) / change.evaluations : 0;
  }
  /// What is left of an error and what it costs at a price, the least over divisions.
  static double least(double error, Kind const& kind, int divisions, double price) {
    double evaluations = kind.evaluations, best = error + price * evaluations;
    for (int k = 0; k < divisions; ++k) {
      error *= kind.factor;
      evaluations *= kind.children;
      double const now = error + price * evaluations;
      if (now >= best) break;
      best = now;
    }
    return best;
  }
  double of_group(Element const& own, std::size_t k) const {
    return of_groups_[own.first_of_groups + k];
  }
  /// The group in which what it gets wrong and its price are least: of those that cost more than its own, or of those that
  /// cost less.
  std::size_t group(Element const& own, Limits const& limits) const {
    auto const best = [&](double price) {
      std::size_t found = 0;
      for (std::size_t k = 1; k < own.groups; ++k)
        if (of_group(own, k) + price * own.evaluations(k) <
            of_group(own, found) + price * own.evaluations(found))
          found = k;
      return found;
    };
    if (own.groups == 1) return 0;
    auto const up = best(limits.make);
    return up > own.group ? up : std::min(best(release_ * limits.undo), own.group);
  }
  /// The first step to where the error and its price are least.
  Action action(Element const& own, Limits const& limits) const {
    auto const in_group = group(own, limits);
    auto const& [kind, higher, lower] = own.kinds[in_group];
    if (higher != nullptr && least(raising * own.error, *higher, own.divisions, limits.make) <
                                 least(own.error, kind, own.divisions, limits.make))
      return Action::raise;
    if (worth(own.error, change(own, in_group, Action::divide)) > limits.make)
      return Action::divide;
    auto const lowered = change(own, in_group, Action::lower);
    bool const lowers = lowered.is_there() && worth(own.error, lowered) < release_ * limits.undo &&
                        !(own.family != no_family && merges(own.family, limits));
    return lowers ? Action::lower : Action::none;
  }

  double release_, error_ = 0, evaluations_ = 0;
  std::vector<Element> elements_;
  std::vector<double> of_groups_;  // J, of each element in each of its groups
  std::vector<Family> families_;
};

}  // namespace pliant::detail

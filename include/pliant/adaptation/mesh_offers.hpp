#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include <pliant/backend/backend.hpp>
#include <pliant/body/criteria_workspace.hpp>
#include <pliant/math/functions.hpp>

// What changes of a mesh, and of the groups of its elements, are worth, in joules per evaluation: those worth more than one
// limit are made, and undone where they are those worth less than another.
namespace pliant::detail {

/// Elements of one formulation: what a division makes of one, and which have another degree on the same cell.
struct OfferKind {
  double factor = 1;  // of the error
  int children = 1;
  double evaluations = 0;       // of one element
  int higher = -1, lower = -1;  // kinds; −1: none
};

/// J per evaluation.
struct OfferLimits {
  double make, undo;
};

enum class MeshAction : std::uint8_t { none, divide, raise, lower };

/// An element as it is now.
struct OfferedElement {
  double error;           // J
  std::uint8_t place;     // of its formulation among those of its type
  bool sleeps, may_move;  // or stays in its group
};

/// What is left of an error, J, and how many evaluations that takes.
struct OfferOutcome {
  double error, evaluations;
};

/// Of a family that may be merged. No evaluations: one of it sleeps.
using OfferedFamily = OfferOutcome;

/// The elements of one type, by the user's number, in one of `Count` groups to which they may go, each costlier than the one
/// before; `Kinds`: in how many formulations those of all types are. Arrays are in the backend's memory.
template <int Count, int Kinds>
struct MeshOffers {
  /// What raising makes of an error, and lowering: more than that undoes, since smooth solutions lose more, and elements
  /// that go back and forth cost more than a few that are raised too long.
  static constexpr double raising = 1.0 / 16, lowering = 64;

  OfferKind kinds[Kinds];
  int first;       // kind of its groups
  double release;  // what is there is taken to be worth 1/release times as much as what is not
  int max_level;
  Siblings const* siblings;
  OfferedElement const* elements;
  OfferedFamily const* families;  // by the first sibling
  double const* of_groups;  // (elements, Count), J: what each group gets wrong whatever the mesh

  /// The group in which what it gets wrong and its price are least: of those that cost more than its own, or of those that
  /// cost less.
  PLIANT_HOST_DEVICE int group(Index e, OfferLimits const& limits) const {
    auto const& own = elements[e];
    if (Count == 1 || !own.may_move) return own.place;
    int const up = cheapest(e, limits.make);
    return up > own.place ? up : min(cheapest(e, release * limits.undo), int{own.place});
  }
  /// The first step to where the error and its price are least, of an element in a group.
  PLIANT_HOST_DEVICE MeshAction action(Index e, int in_group, OfferLimits const& limits) const {
    auto const& own = elements[e];
    if (own.sleeps) return MeshAction::none;
    auto const& kind = kinds[first + in_group];
    int const divisions = divisions_of(e);
    if constexpr (has_degrees)
      if (kind.higher >= 0 && least(raising * own.error, kinds[kind.higher], divisions,
                                    limits.make) < least(own.error, kind, divisions, limits.make))
        return MeshAction::raise;
    if (worth(own.error, change(e, in_group, MeshAction::divide)) > limits.make)
      return MeshAction::divide;
    if constexpr (has_degrees) {
      auto const lowered = change(e, in_group, MeshAction::lower);
      if (lowered.is_there() && worth(own.error, lowered) < release * limits.undo &&
          !(siblings[e].first >= 0 && merges(siblings[e].first, limits)))
        return MeshAction::lower;
    }
    return MeshAction::none;
  }
  /// Whether a family is merged, by its first element.
  PLIANT_HOST_DEVICE bool merges(Index e, OfferLimits const& limits) const {
    auto const merged = merging(e);
    return merged.is_there() && worth(families[e].error, merged) < release * limits.undo;
  }
  PLIANT_HOST_DEVICE bool is_first(Index e) const { return siblings[e].first == e; }

  /// Of an element, and, if it is the first of a family, of what merging that changes.
  PLIANT_HOST_DEVICE OfferOutcome at(Index e, OfferLimits const& limits) const {
    auto const& own = elements[e];
    if (own.sleeps) return {own.error, 0};
    int const to = group(e, limits);
    OfferOutcome found{own.error + of_group(e, to), kinds[first + to].evaluations};
    auto const make = [&found](double error, Change const& change) {
      found.error += error * (change.factor - 1);
      found.evaluations += change.evaluations;
    };
    make(own.error, change(e, to, action(e, to, limits)));
    if (is_first(e) && merges(e, limits)) make(families[e].error, merging(e));
    return found;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE double error_now(Index e) const {
    return elements[e].error + of_group(e, elements[e].place);
  }
  /// Whether two limits make the same of it.
  PLIANT_HOST_DEVICE bool is_same(Index e, OfferLimits const& one, OfferLimits const& other) const {
    int const to = group(e, one);
    return to == group(e, other) && action(e, to, one) == action(e, to, other) &&
           (!is_first(e) || merges(e, one) == merges(e, other));
  }

  /// Calls visit(J per evaluation) for each change of an element that has to do with none of its family's.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_worths(Index e, Visit const& visit) const {
    auto const& own = elements[e];
    if (own.sleeps) return;
    int const from = own.may_move ? 0 : own.place, to = own.may_move ? Count - 1 : own.place;
    for (int k = from; k <= to; ++k) {
      for (auto const each : {MeshAction::divide, MeshAction::raise, MeshAction::lower})
        visit(worth(own.error, change(e, k, each)));
      for (int j = from; j < k; ++j)
        visit((of_group(e, j) - of_group(e, k)) / (evaluations(k) - evaluations(j)));
    }
    if (is_first(e)) visit(worth(families[e].error, merging(e)));
  }
  PLIANT_HOST_DEVICE double evaluations(int in_group) const {
    return kinds[first + in_group].evaluations;
  }

 private:
  static constexpr bool has_degrees = Kinds > Count;
  /// By which factor an error changes, and by how much the evaluations; nothing where they do not.
  struct Change {
    double factor = 1, evaluations = 0;
    PLIANT_HOST_DEVICE bool is_there() const { return evaluations != 0; }
  };

  PLIANT_HOST_DEVICE int divisions_of(Index e) const {
    return max(0, max_level - int{siblings[e].level});
  }
  PLIANT_HOST_DEVICE double of_group(Index e, int k) const {
    if constexpr (Count == 1)
      return 0;
    else
      return elements[e].may_move ? of_groups[static_cast<std::ptrdiff_t>(Count) * e + k] : 0;
  }
  PLIANT_HOST_DEVICE Change change(Index e, int in_group, MeshAction action) const {
    auto const& kind = kinds[first + in_group];
    if (action == MeshAction::divide && divisions_of(e) > 0)
      return {kind.factor, (kind.children - 1) * kind.evaluations};
    if (action == MeshAction::raise && kind.higher >= 0)
      return {raising, kinds[kind.higher].evaluations - kind.evaluations};
    if (action == MeshAction::lower && kind.lower >= 0)
      return {lowering, kinds[kind.lower].evaluations - kind.evaluations};
    return {};
  }
  PLIANT_HOST_DEVICE Change merging(Index e) const {
    return {1 / kinds[first].factor, (1.0 / siblings[e].count - 1) * families[e].evaluations};
  }
  /// J per evaluation.
  static PLIANT_HOST_DEVICE double worth(double error, Change const& change) {
    return change.is_there() ? error * (1 - change.factor) / change.evaluations : 0;
  }
  /// What is left of an error and what it costs at a price, the least over divisions.
  static PLIANT_HOST_DEVICE double least(double error, OfferKind const& kind, int divisions,
                                         double price) {
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
  PLIANT_HOST_DEVICE int cheapest(Index e, double price) const {
    int found = 0;
    for (int k = 1; k < Count; ++k)
      if (of_group(e, k) + price * evaluations(k) < of_group(e, found) + price * evaluations(found))
        found = k;
    return found;
  }
};

/// Adds up what families offer, by their first elements.
template <class Offers>
struct AddUpFamilies {
  Offers offers;
  OfferedFamily* families;
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    if (!offers.is_first(e)) return;
    OfferedFamily sum{0, 0};
    bool sleeps = false;
    for (Index k = e; k < e + offers.siblings[e].count; ++k) {
      auto const& own = offers.elements[k];
      sum.error += own.error;
      sum.evaluations += offers.evaluations(own.place);
      sleeps = sleeps || own.sleeps;
    }
    if (sleeps) sum.evaluations = 0;
    families[e] = sum;
  }
};

/// The elements of a list, or all.
struct ListedOrAll {
  Index const* list = nullptr;
  PLIANT_HOST_DEVICE Index operator[](Index i) const { return list == nullptr ? i : list[i]; }
};

enum class OfferSum { error, evaluations };

/// Limits that are tried, of which one at least is in the backend's memory.
struct TriedLimits {
  double const* tried;  // J per evaluation
  double undo;          // NaN: as well as it makes
  PLIANT_HOST_DEVICE OfferLimits operator()() const {
    return {*tried, undo == undo ? undo : *tried};
  }
};

/// What limits make of elements, for sums.
template <class Offers>
struct OutcomeAt {
  Offers offers;
  ListedOrAll listed;
  OfferSum of;
  TriedLimits limits;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    auto const found = offers.at(listed[i], limits());
    return of == OfferSum::error ? found.error : found.evaluations;
  }
};
/// What elements get wrong now, J.
template <class Offers>
struct ErrorNow {
  Offers offers;
  PLIANT_HOST_DEVICE double operator()(Index e) const { return offers.error_now(e); }
};
/// What limits make of elements of which two make the same.
template <class Offers>
struct SettledOutcome {
  OutcomeAt<Offers> at;
  TriedLimits other;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return at.offers.is_same(at.listed[i], at.limits(), other()) ? at(i) : 0;
  }
};
/// And those of which they do not, for select.
template <class Offers>
struct IsOpen {
  Offers offers;
  ListedOrAll listed;
  TriedLimits one, other;
  PLIANT_HOST_DEVICE bool operator()(Index i) const {
    return !offers.is_same(listed[i], one(), other());
  }
};
/// The largest worth of a change, or the inverse of the least one above zero; 0 where there is none.
template <class Offers>
struct FarthestWorth {
  Offers offers;
  bool inverse;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    double farthest = 0;
    offers.visit_worths(e, [this, &farthest](double own) {
      if (own >= std::numeric_limits<double>::min())
        farthest = max(farthest, inverse ? 1 / own : own);
    });
    return farthest;
  }
};

}  // namespace pliant::detail

#pragma once

#include <cstddef>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/field.hpp>
#include <pliant/body/exact_sum.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/topology/changed_elements.hpp>

// Passes over elements that go or come in a change of a mesh, and the nodes that it touches, for loops of a backend.
namespace pliant::detail {

/// Lists rows, each once.
struct TouchOnce {
  Index* place;  // by row: zero where it is not listed yet
  Index* list;
  Index* count;

  PLIANT_HOST_DEVICE void operator()(Index row) const {
    if (atomic_peek(place[row]) != 0) return;
    Index seen = atomic_load(place[row]);
    while (seen == 0)
      if (atomic_exchange(place[row], seen, 1)) {
        list[atomic_add(*count, 1)] = row;
        return;
      }
  }
};
template <class Members>
struct TouchMembers {
  Members members;
  TouchOnce touch;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (!members.is_one(i)) return;
    for (Index const row : members.rows(i)) touch(row);
  }
};
struct TouchListed {
  Index const* rows;
  TouchOnce touch;
  PLIANT_HOST_DEVICE void operator()(Index i) const { touch(rows[i]); }
};
/// A pass over entries of the list, with a call for each that there may be.
template <class Pass>
struct ForListed {
  Index const* count;
  Pass pass;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (i < *count) pass(i);
  }
};
struct ForgetPlaces {
  Index const* list;
  Index* place;
  PLIANT_HOST_DEVICE void operator()(Index i) const { place[list[i]] = 0; }
};
/// Numbers the rows of the list, and notes the masses that nodes have now.
struct NoteMass {
  Index const* list;
  Index* place;
  SumUnit unit;
  ExactSum const* own;  // by row
  double* masses;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    place[list[i]] = i + 1;
    masses[i] = unit.value_of(own[list[i]]);
  }
};

/// Values at the rows of the list.
template <int Dim>
struct DoublesByPlace {
  Index const* place;
  double* values;  // (places, Dim)
  PLIANT_HOST_DEVICE double& operator()(Index row, int k) const {
    return values[static_cast<std::ptrdiff_t>(Dim) * (place[row] - 1) + k];
  }
};
template <class T, int Dim>
struct TakeVelocities {
  Index const* list;
  NodeField<T, Dim> v;
  double *before, *now;
  ExactSum* sums;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const own = v.at(list[i]);
    for (int k = 0; k < Dim; ++k) {
      auto const to = static_cast<std::ptrdiff_t>(Dim) * i + k;
      before[to] = now[to] = static_cast<double>(own[k]);
      sums[to] = {};
    }
  }
};

/// Adds what the nodes of a family must be given so that it keeps its momentum: see list_family_impulse.
template <ChangedFamilies Families>
struct AddFamilyImpulse {
  static constexpr int dim = Families::come_element::dim;
  Families families;
  double density;
  DoublesByPlace<dim> before, now;  // velocities, those of slaves as their mass moves
  SumUnit unit;
  Index const* place;
  ExactSum* sums;
  Index* refused;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const gone = families.gone(r), come = families.come(r), tets = count_tets<false>(r),
                all_gone = gone + tets, all_come = come + count_tets<true>(r),
                members = all_gone + all_come, steps = members + all_come;
    double base[dim] = {}, lost[dim] = {}, volume = 0;
    bool is_done = false;
    constexpr bool shares_base = requires { families.base_row(r); };
    if constexpr (shares_base)
      for (int d = 0; d < dim && members > 0; ++d)
        base[d] = (gone > 1 ? now : before)(families.base_row(r), d);
    // First those that go, then those that come; then these again, which take their shares.
    for (Index step = 0; step < steps && !is_done; ++step)
      with_member(r, step < all_gone, step < all_gone ? step : (step - all_gone) % all_come, gone,
                  come, [&](auto const& elements, auto const& rows, bool goes) {
                    auto const own = elements.volumes(rows);
                    constexpr int nodes =
                        static_cast<int>(std::tuple_size_v<std::remove_cvref_t<decltype(rows)>>);
                    if (step < members) {
                      for (int d = 0; d < dim && step == 0 && !shares_base; ++d)
                        base[d] = before(rows[0], d);
                      for (int a = 0; a < nodes; ++a) {
                        Index const row = rows[static_cast<std::size_t>(a)];
                        for (int d = 0; d < dim; ++d) {
                          double const momentum =
                              density * own[a] * ((goes ? before(row, d) : now(row, d)) - base[d]);
                          lost[d] += goes ? momentum : -momentum;
                        }
                        if (!goes) volume += own[a];
                      }
                      if (step < members - 1) return;
                      bool kept = true;
                      for (double const x : lost) kept = kept && x == 0;
                      is_done = kept;
                    } else {
                      for (int a = 0; a < nodes; ++a)
                        for (int d = 0; d < dim; ++d)
                          add(rows[static_cast<std::size_t>(a)], d, lost[d] * (own[a] / volume));
                    }
                  });
  }

 private:
  static constexpr bool has_tets = requires(Families const& some) { some.tets; };

  /// How many tetrahedra go, or come, with pyramids.
  template <bool Come>
  [[nodiscard]] PLIANT_HOST_DEVICE Index count_tets(Index r) const {
    if constexpr (has_tets)
      return Come ? families.tets.come(r) : families.tets.gone(r);
    else
      return 0;
  }
  /// visit(what its type has, its rows, whether it goes) for the k-th that goes, or comes: tetrahedra stand behind those of the
  /// family's type.
  template <class Visit>
  PLIANT_HOST_DEVICE void with_member(Index r, bool goes, Index k, Index gone, Index come,
                                      Visit const& visit) const {
    if constexpr (has_tets) {
      auto const& tets = families.tets;
      if (goes && k >= gone) return visit(tets.elements, tets.rows_gone(r, k - gone), true);
      if (!goes && k >= come) return visit(tets.elements, tets.rows_come(r, k - come), false);
    }
    if constexpr (std::same_as<typename Families::gone_element, typename Families::come_element>)
      visit(families.elements, goes ? families.rows_gone(r, k) : families.rows_come(r, k), goes);
    else if (goes)
      visit(elements_of<false>(families), families.rows_gone(r, k), true);
    else
      visit(elements_of<true>(families), families.rows_come(r, k), false);
  }
  PLIANT_HOST_DEVICE void add(Index row, int d, double x) const {
    if (unit.holds(abs(x)))
      sums[static_cast<std::ptrdiff_t>(dim) * (place[row] - 1) + d].add_from_threads(
          unit.signed_multiple_of(x));
    else
      atomic_store(*refused, 1);
  }
};

/// What families give a node, and what it must be given where it begins or ceases to hang, or hangs otherwise: the difference in
/// the velocity at which the mass moves that it has of elements that stay.
template <int Dim>
struct AddImpulseOfSlave {
  SumUnit unit;
  ExactSum const* sums;
  double const *staying_mass, *before, *now;
  double* impulse;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k) {
      auto const own = static_cast<std::ptrdiff_t>(Dim) * i + k;
      impulse[own] = unit.signed_value_of(sums[own]) + staying_mass[i] * (before[own] - now[own]);
    }
  }
};
template <int Dim>
struct CheckImpulses {
  SumUnit unit;
  double const* impulse;
  Index* refused;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k)
      if (!unit.holds(abs(impulse[static_cast<std::ptrdiff_t>(Dim) * i + k])))
        atomic_store(*refused, 1);
  }
};
/// What held nodes took of impulses, and whether any impulse was refused.
template <int Dim>
struct TakenMomentum {
  ExactSum sums[Dim];
  Index refused = 0, unused = 0;
};
/// Changes the velocity of a node where it is not held; of none where an impulse was refused.
template <class T, int Dim>
struct GiveImpulses {
  Index const* list;
  double const *impulse, *kilograms;
  DirectionMask const* held;
  SumUnit unit;
  NodeField<T, Dim> v;
  TakenMomentum<Dim>* taken;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (taken->refused != 0) return;
    Index const row = list[i];
    for (int k = 0; k < Dim; ++k) {
      double const own = impulse[static_cast<std::ptrdiff_t>(Dim) * i + k];
      if (own == 0) continue;
      if (held != nullptr && (held[row] >> k & 1) != 0)
        taken->sums[k].add_from_threads(unit.signed_multiple_of(own));
      else if (kilograms[row] > 0)
        v(row, k) = static_cast<T>(static_cast<double>(v(row, k)) + own / kilograms[row]);
    }
  }
};

}  // namespace pliant::detail

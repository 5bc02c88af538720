#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/exact_sum.hpp>
#include <pliant/constraint/mass_weights_on.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/changed_elements.hpp>

namespace pliant {

namespace detail {

/// Adds the shares that nodes have in the masses of some elements to the nodes' own; or takes them away. As share_mass and
/// lumped_masses do.
template <class Members>
struct AddShares {
  Members members;
  bool takes;
  double density;
  SumUnit unit;
  ExactSum* own;   // by row
  Index* refused;  // set where a share is no number, or too large

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (!members.is_one(i)) return;
    auto const rows = members.rows(i);
    auto const shares = members.elements().masses(rows, density);
    for (int a = 0; a < Members::element::nodes; ++a) {
      if (!unit.holds(shares[a])) {
        atomic_store(*refused, 1);
        continue;
      }
      auto const share = unit.multiple_of(shares[a]);
      own[rows[static_cast<std::size_t>(a)]].add_from_threads(takes ? -share : share);
    }
  }
};

struct ReadMasses {
  SumUnit unit;
  ExactSum const* own;
  double* kilograms;
  ExactSum* copy;  // null: none
  PLIANT_HOST_DEVICE void operator()(Index row) const {
    ExactSum const sum = own[row];
    kilograms[row] = unit.value_of(sum);
    if (copy != nullptr) copy[row] = sum;
  }
};

/// Masses in a body's precision, as checked_mass has them.
template <class T>
struct RoundMasses {
  double const* kilograms;
  T* masses;
  Index* refused;  // set where T cannot hold one
  PLIANT_HOST_DEVICE void operator()(Index row) const {
    T const m = static_cast<T>(kilograms[row]);
    bool const is_held = m - m == T(0) && (m > T(0) || !(kilograms[row] > 0));
    if (!is_held) atomic_store(*refused, 1);
    masses[row] = m;
  }
};

}  // namespace detail

/// The lumped masses of nodes by their rows, in a backend's memory, as sums that do not depend on the order of elements: those of a
/// mesh that was changed have the bits of those of one made anew. Rows that no node has hold zero. Elements that go and come are
/// told type by type.
template <Backend B>
class NodalMassesOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// `own`: by row, slaves' with them (see lumped_masses). `density`: kg/m³.
  NodalMassesOn(B const& backend, std::vector<detail::ExactSum> const& own,
                detail::SumUnit const& unit, double density)
      : backend_(backend),
        own_(upload(backend, own)),
        rows_(static_cast<Index>(own.size())),
        unit_(unit),
        density_(density),
        refused_(backend, 2) {
    refused_.set_all(0);
  }

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] double density() const { return density_; }
  [[nodiscard]] detail::SumUnit const& unit() const { return unit_; }
  /// By row, slaves' with them.
  [[nodiscard]] detail::ExactSum const* own() const { return own_.data(); }

  /// Makes room for rows of new nodes.
  void extend(Index rows) {
    if (rows <= rows_) return;
    detail::grow_keeping(backend_, own_, at(rows_), at(rows));
    rows_ = rows;
  }
  /// What nodes have of elements that go in a change goes: of nodes that go, all.
  template <detail::ChangedFamilies... Families>
  void take_gone(Families const&... families) {
    detail::in_turn(backend_, taking_gone(families)...);
  }
  /// What they have of those that come comes.
  template <detail::ChangedFamilies... Families>
  void add_come(Families const&... families) {
    detail::in_turn(backend_, adding_come(families)...);
  }
  /// Both of them as steps of loops (see in_turn).
  template <detail::ChangedFamilies Families>
  [[nodiscard]] auto taking_gone(Families const& families) {
    return shares<false>(families, true);
  }
  template <detail::ChangedFamilies Families>
  [[nodiscard]] auto adding_come(Families const& families) {
    return shares<true>(families, false);
  }
  /// Undoes both, to the bit.
  template <detail::ChangedFamilies... Families>
  void take_back(Families const&... families) {
    detail::in_turn(backend_, shares<true>(families, true)..., shares<false>(families, false)...);
  }
  /// Masses in kg by row, of which slaves have handed theirs to their masters; and a copy of `own`, or null. Both: (rows).
  void read(MassWeightsOn<B> const& slaves, double* kilograms,
            detail::ExactSum* own_copy = nullptr) const {
    backend_.for_each(rows_, detail::ReadMasses{unit_, own_.data(), kilograms, own_copy});
    slaves.template hand<1>(detail::DoublesByRow<1>{kilograms});
  }
  /// The same masses in another precision.
  template <class T>
  void round(double const* kilograms, T* masses) {
    backend_.for_each(rows_, detail::RoundMasses<T>{kilograms, masses, refused_.data() + 1});
  }
  /// Once the backend was waited for: throws Error where a precision could not hold a mass, and where the share of a node in the
  /// mass of an element was no number or too large since the last call: such shares were left out.
  template <class T>
  void check() {
    auto const refused = refused_.template first<2>();
    bool const is_held = refused[1] == 0 && std::isfinite(static_cast<T>(density_));
    if (refused[0] == 0 && is_held) return;
    refused_.set_all(0);
    if (refused[0] != 0)
      throw Error(
          "body: the share of a node in the mass of an element is too large, or no number, under "
          "the density ",
          density_, " kg/m³; take other units");
    throw Error("body: ", 8 * sizeof(T), " bits cannot hold the mass of a node under the density ",
                density_, " kg/m³; take double, or other units");
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <bool Come, class Families>
  auto shares(Families const& families, bool takes) {
    using Members = detail::MembersOf<Families, Come>;
    Members const members{families};
    return detail::LoopStep{
        members.places(),
        detail::AddShares<Members>{members, takes, density_, unit_, own_.data(), refused_.data()}};
  }

  B backend_;
  Array<detail::ExactSum> own_;
  Index rows_;
  detail::SumUnit unit_;
  double density_;
  ReadBack<B, Index> refused_;  // shares; masses
};

}  // namespace pliant

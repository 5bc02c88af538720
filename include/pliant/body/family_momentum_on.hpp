#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/exact_sum.hpp>
#include <pliant/body/family_momentum_passes.hpp>
#include <pliant/body/nodal_masses_on.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/constraint/mass_weights_on.hpp>
#include <pliant/constraint/rows_on.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// Gives elements that are refined or merged their momentum back, as give_momentum_back does on the host, in a backend's memory:
/// by the rows of fields. Families are told type by type.
template <int Dim, Backend B>
class FamilyMomentumOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;
  static constexpr int dim = Dim;

 public:
  explicit FamilyMomentumOn(B const& backend) : backend_(backend), told_(backend, 1) {}

  /// Takes nodes the masses of elements that go, and gives them those of elements that come. Looks up which nodes a change touches, and
  /// what these have of the masses of elements that stay. `before`, `now`: of the slaves that there were, and are.
  template <detail::ChangedFamilies... Families>
  void begin(MassWeightsOn<B> const& before, MassWeightsOn<B> const& now, NodalMassesOn<B>& masses,
             Families const&... families) {
    auto const rows = at(masses.rows());
    detail::grow_zeroed(backend_, place_, rows);
    detail::grow(backend_, list_, rows);
    detail::grow(backend_, counter_, 1);
    detail::TouchOnce const touch{place_.data(), list_.data(), counter_.data()};
    auto const touch_members = [&]<class Own>(Own const& own) {
      // Those that are more, or have more nodes, have the nodes of the others.
      using Members = detail::MembersOf<Own, (most_nodes<Own, true> > most_nodes<Own, false>)>;
      Members const members{own};
      return detail::LoopStep{members.places(), detail::TouchMembers<Members>{members, touch}};
    };
    auto const touch_all = [&](RowsOn<B> const& some) {
      return detail::LoopStep{some.count, detail::TouchListed{some.node.data(), touch}};
    };
    auto const &slaves_before = before.interpolation(), &slaves_now = now.interpolation();
    std::size_t most = 0;
    ((most +=
      at(std::max(most_nodes<Families, true>, most_nodes<Families, false>)) * at(families.count)),
     ...);
    for (auto const* slaves : {&slaves_before, &slaves_now})
      most += at(slaves->slaves().count) + at(slaves->masters().count);
    most_ = static_cast<Index>(std::min(most, rows));
    detail::grow(backend_, staying_mass_, at(most_));
    detail::in_turn(backend_, masses.taking_gone(families)...,
                    detail::LoopStep{1, detail::FillValue<Index>{counter_.data(), 0}},
                    touch_members(families)..., touch_all(slaves_before.slaves()),
                    touch_all(slaves_before.masters()), touch_all(slaves_now.slaves()),
                    touch_all(slaves_now.masters()),
                    of_listed(detail::NoteMass{list_.data(), place_.data(), masses.unit(),
                                               masses.own(), staying_mass_.data()}),
                    masses.adding_come(families)...);
  }

  /// Changes the velocities `v`, to which a refinement gave new nodes theirs, so that each family keeps its momentum. Slaves keep
  /// their velocities, and have to follow their masters then; nodes that went keep theirs. `kilograms`: masses by row, as
  /// NodalMassesOn::read gives them. `held`: directions by row; null: none. `bound`: kg m/s, more than the sum of all impulses
  /// that nodes could be given, 8 times the body's mass at the largest speed, say. Where an impulse exceeds it or is no number,
  /// velocities stay, and `taken` says so.
  template <detail::ChangedFamilies... Families>
  void give_back(MassWeightsOn<B> const& before, MassWeightsOn<B> const& now, double density,
                 double bound, double const* kilograms, DirectionMask const* held,
                 NodeField<T, dim> v, Families const&... families) {
    bound_ = bound;
    detail::SumUnit const unit(bound);
    auto const values = at(most_) * dim;
    for (auto* array : {&before_, &now_, &impulse_}) detail::grow(backend_, *array, values);
    detail::grow(backend_, sums_, values);
    taken_ = zeros<detail::TakenMomentum<dim>>(backend_, 1);
    auto* const refused = &taken_.data()->refused;
    using Placed = detail::DoublesByPlace<dim>;
    Placed const v_before{place_.data(), before_.data()}, v_now{place_.data(), now_.data()},
        impulse{place_.data(), impulse_.data()};
    auto const add_impulses = [&]<class Own>(Own const& own) {
      return detail::LoopStep{own.count,
                              detail::AddFamilyImpulse<Own>{own, density, v_before, v_now, unit,
                                                            place_.data(), sums_.data(), refused}};
    };
    detail::in_turn(
        backend_,
        of_listed(detail::TakeVelocities<T, dim>{list_.data(), v, before_.data(), now_.data(),
                                                 sums_.data()}),
        before.template applying<dim>(v_before), now.template applying<dim>(v_now),
        add_impulses(families)...,
        of_listed(detail::AddImpulseOfSlave<dim>{unit, sums_.data(), staying_mass_.data(),
                                                 before_.data(), now_.data(), impulse_.data()}),
        now.template handing<dim>(impulse), now.template clearing<dim>(impulse),
        of_listed(detail::CheckImpulses<dim>{unit, impulse_.data(), refused}),
        of_listed(detail::GiveImpulses<T, dim>{list_.data(), impulse_.data(), kilograms, held, unit,
                                               v, taken_.data()}),
        of_listed(detail::ForgetPlaces{list_.data(), place_.data()}),
        detail::LoopStep{
            1, detail::CopyValue<detail::TakenMomentum<dim>>{taken_.data(), told_.data()}});
    most_ = 0;
  }
  /// What held nodes took of momentum, N s, once the backend was waited for. Throws Error where an impulse was refused.
  [[nodiscard]] Point<dim> taken() const {
    auto const taken = told_.template first<1>()[0];
    if (taken.refused != 0)
      throw Error(
          "change of the mesh: the momentum that a node is given is no number, or exceeds the "
          "bound of ",
          bound_, " kg m/s; give one for all nodes together");
    detail::SumUnit const unit(bound_);
    Point<dim> sum{};
    for (std::size_t k = 0; k < dim; ++k) sum[k] = unit.signed_value_of(taken.sums[k]);
    return sum;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Of the elements of a family that come, or go.
  template <class Families, bool Come>
  static constexpr Index most_nodes =
      detail::MembersOf<Families, Come>::element::nodes * detail::MembersOf<Families, Come>::most;
  /// A pass over what is listed.
  template <class Pass>
  auto of_listed(Pass const& pass) const {
    return detail::LoopStep{most_, detail::ForListed<Pass>{counter_.data(), pass}};
  }

  B backend_;
  Array<Index> place_;    // by row: in the list, one more; zero, as between two changes: not there
  Array<Index> list_;     // rows of the nodes that are touched
  Index most_ = 0;        // of them
  Array<Index> counter_;  // how many there are
  Array<double> staying_mass_, before_, now_,
      impulse_;  // by place; values of components side by side
  Array<detail::ExactSum> sums_;
  Array<detail::TakenMomentum<dim>> taken_;
  ReadBack<B, detail::TakenMomentum<dim>> told_;
  double bound_ = 0;  // kg m/s
};

}  // namespace pliant

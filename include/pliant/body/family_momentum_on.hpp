#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/body/exact_sum.hpp>
#include <pliant/body/family_momentum_passes.hpp>
#include <pliant/body/nodal_masses_on.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/constraint/mass_weights_on.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// Gives elements that are refined or merged their momentum back, as give_momentum_back does on the host, in a backend's memory:
/// by the rows of fields, of a mesh with elements of one type.
template <Element E, Backend B>
class FamilyMomentumOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;
  static constexpr int dim = E::dim;

 public:
  explicit FamilyMomentumOn(B const& backend) : backend_(backend) {}

  /// Looks up which nodes a change touches, and what these have of the masses of elements that stay; between
  /// NodalMassesOn::take_gone and add_come. `before`, `now`: of the slaves that there were, and are.
  template <detail::ChangedFamilies<E> Families>
  void begin(Families const& families, MassWeightsOn<B> const& before, MassWeightsOn<B> const& now,
             NodalMassesOn<E, B> const& masses) {
    auto const rows = at(masses.rows());
    detail::grow_zeroed(backend_, place_, rows);
    detail::grow(backend_, list_, rows);
    counters_ = zeros<Index>(backend_, 2);
    detail::TouchOnce const touch{place_.data(), list_.data(), counters_.data()};
    // The many have the nodes of the few.
    using Members = detail::MembersOf<Families, (Families::most_come > Families::most_gone)>;
    Members const members{families};
    backend_.for_each(members.places(), detail::TouchMembers<Members>{members, touch});
    for (auto const* weights : {&before, &now})
      for (auto const* some :
           {&weights->interpolation().slaves(), &weights->interpolation().masters()})
        backend_.for_each(some->count, detail::TouchListed{some->node.data(), touch});
    count_ = download<Index>(counters_)[0];
    detail::grow(backend_, staying_mass_, at(count_));
    backend_.for_each(count_, detail::NoteMass{list_.data(), place_.data(), masses.unit(),
                                               masses.own(), staying_mass_.data()});
  }

  /// Changes the velocities `v`, to which a refinement gave new nodes theirs, so that each family keeps its momentum; returns
  /// what held nodes took of it, N s. Slaves keep their velocities, and have to follow their masters then; nodes that went keep
  /// theirs. `kilograms`: masses
  /// by row, as NodalMassesOn::read gives them. `held`: directions by row; null: none. `bound`: kg m/s, more than the sum of all
  /// impulses that nodes could be given, 8 times the body's mass at the largest speed, say. Throws Error, with velocities as
  /// they were, where an impulse exceeds it or is no number.
  template <detail::ChangedFamilies<E> Families>
  Point<dim> give_back(Families const& families, MassWeightsOn<B> const& before,
                       MassWeightsOn<B> const& now, double density, double bound,
                       double const* kilograms, DirectionMask const* held, NodeField<T, dim> v) {
    detail::SumUnit const unit(bound);
    auto const values = at(count_) * dim;
    for (auto* array : {&before_, &now_, &impulse_}) detail::grow(backend_, *array, values);
    detail::grow(backend_, sums_, values);
    taken_ = zeros<detail::ExactSum>(backend_, dim);
    using Placed = detail::DoublesByPlace<dim>;
    Placed const v_before{place_.data(), before_.data()}, v_now{place_.data(), now_.data()},
        impulse{place_.data(), impulse_.data()};
    backend_.for_each(count_, detail::TakeVelocities<T, dim>{list_.data(), v, before_.data(),
                                                             now_.data(), sums_.data()});
    before.template apply<dim>(v_before);
    now.template apply<dim>(v_now);
    Index* const refused = counters_.data() + 1;
    backend_.for_each(families.count, detail::AddFamilyImpulse<E, Families>{
                                          families, density, v_before, v_now, unit, place_.data(),
                                          sums_.data(), refused});
    backend_.for_each(count_,
                      detail::AddImpulseOfSlave<dim>{unit, sums_.data(), staying_mass_.data(),
                                                     before_.data(), now_.data(), impulse_.data()});
    now.template hand<dim>(impulse);
    backend_.for_each(count_, detail::CheckImpulses<dim>{unit, impulse_.data(), refused});
    bool const was_refused = download<Index>(counters_)[1] != 0;
    if (!was_refused)
      backend_.for_each(
          count_, detail::GiveImpulses<T, dim>{list_.data(), impulse_.data(), kilograms, held, unit,
                                               v, taken_.data()});
    backend_.for_each(count_, detail::ForgetPlaces{list_.data(), place_.data()});
    count_ = 0;
    if (was_refused)
      throw Error(
          "change of the mesh: the momentum that a node is given is no number, or exceeds the "
          "bound of ",
          bound, " kg m/s; give one for all nodes together");
    auto const taken = download<detail::ExactSum>(taken_);
    Point<dim> sum{};
    for (std::size_t k = 0; k < dim; ++k) sum[k] = unit.signed_value_of(taken[k]);
    return sum;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  B backend_;
  Array<Index> place_;  // by row: in the list, one more; zero, as between two changes: not there
  Array<Index> list_;   // rows of the nodes that are touched
  Index count_ = 0;     // of them
  Array<Index> counters_;
  Array<double> staying_mass_, before_, now_,
      impulse_;  // by place; values of components side by side
  Array<detail::ExactSum> sums_, taken_;
};

}  // namespace pliant

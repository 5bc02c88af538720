#pragma once

#include <concepts>

#include <pliant/adaptation/criterion/state_in_body.hpp>
#include <pliant/adaptation/criterion/unit.hpp>

namespace pliant {

/// A criterion that takes means at nodes: see criterion/neighbours.hpp.
template <class C, class F>
concept CriterionOfMeans =
    std::copy_constructible<C> && detail::TakesMeans<C, F> &&
    requires(C const& criterion,
             ElementState<F, detail::LawInKernels<F, double>, double> const& element,
             Matrix<double, F::nodes, C::template nodal_values<F>> const& means) {
      {
        criterion.to_nodes(element)
      } -> std::same_as<Matrix<double, F::nodes, C::template nodal_values<F>>>;
      { criterion(element, means) } -> std::convertible_to<double>;
    };

/// A number for the present state of an element of the formulation F. NaN marks no element: rules
/// pass over elements for which a criterion gives NaN.
template <class C, class F>
concept Criterion =
    CriterionOfMeans<C, F> || (std::copy_constructible<C> &&
                               requires(C const& criterion, detail::StateProbe<F> const& element) {
                                 { criterion(element) } -> std::convertible_to<double>;
                               });

/// A criterion in joules, of the error that the present mesh, law or quadrature makes in an element: the strain
/// energy ½ ∫ Δσ : C⁻¹ : Δσ dV of what is wrong there. Sums over elements compare with the strain energy
/// of the error, ½ (u − u_h)·K (u − u_h), which at equilibrium under dead loads is the potential energy of the
/// body over the least: half the square of the error in the energy norm.
template <class C, class F>
concept Estimator = Criterion<C, F> && Measure<C> && (C::unit == Unit::joule);

/// A criterion that knows a norm |H| = √(H:H) of the displacement gradient that elements have at the least where
/// its value is above a threshold, if H is the same all over the element: checks leave out elements of smaller
/// gradients.
template <class C>
concept BoundedCriterion = requires(C const& criterion, double threshold, int dim) {
  { criterion.least_gradient(threshold, dim) } -> std::convertible_to<double>;
};

/// One that also knows a norm that elements have at the most where its value is below a threshold.
template <class C>
concept BoundedBelowCriterion =
    BoundedCriterion<C> && requires(C const& criterion, double threshold, int dim) {
      { criterion.most_gradient(threshold, dim) } -> std::convertible_to<double>;
    };

namespace detail {
/// Criteria without data are equal when their types are.
template <class C>
inline constexpr bool stateless = std::is_empty_v<C>;
}  // namespace detail

}  // namespace pliant

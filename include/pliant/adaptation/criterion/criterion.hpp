#pragma once

#include <concepts>

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/body/group_laws.hpp>

namespace pliant {

namespace detail {
/// The law that a criterion finds in the state of an element of a formulation.
template <class F, class T>
using LawInKernels =
    std::remove_cvref_t<decltype(std::declval<GroupLaws<T, F> const&>().template law<0>(
        OneElement{}))>;
}  // namespace detail

/// A number for the present state of an element of the formulation F. NaN marks no element: rules
/// pass over elements for which a criterion gives NaN.
template <class C, class F>
concept Criterion =
    std::copy_constructible<C> &&
    requires(C const& criterion,
             ElementState<F, detail::LawInKernels<F, double>, double> const& element) {
      { criterion(element) } -> std::convertible_to<double>;
    };

namespace detail {
/// Criteria without data are equal when their types are.
template <class C>
inline constexpr bool stateless = std::is_empty_v<C>;
}  // namespace detail

}  // namespace pliant

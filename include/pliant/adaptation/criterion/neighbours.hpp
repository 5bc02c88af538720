#pragma once

#include <tuple>

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/body/group.hpp>

// A criterion may look at an element's neighbours through means at nodes:
//
//   struct MyCriterion {
//     template <class F>
//     static constexpr int nodal_values = 2;  // of elements of the formulation F
//     template <class State>                  // what an element gives to the means at its nodes
//     PLIANT_HOST_DEVICE auto to_nodes(State const& e) const { ... }  // Matrix<S, nodes, nodal_values<F>>
//     template <class State, class Means>     // its value, from the means at its nodes
//     PLIANT_HOST_DEVICE auto operator()(State const& e, Means const& means) const { ... }
//   };
//
// Means are over the elements of the group that a rule looks at, weighted by their rest volumes, so that they stop
// where another material begins. What hanging nodes get goes to their masters, and they follow those. Elements
// that give numbers which are not finite do not count. In an element that another rule of the same check has just moved to
// another group the value is NaN: it is found again in the next check.
namespace pliant {

namespace detail {
template <class C, class F>
concept TakesMeans = requires {
  { C::template nodal_values<F> } -> std::convertible_to<int>;
};

template <class A, class B>
struct Joined;
template <class... As, class... Bs>
struct Joined<TypeList<As...>, TypeList<Bs...>> {
  using type = TypeList<As..., Bs...>;
};

/// The criteria in C that take means: itself, or some of those that it is made of.
template <class C, class F>
struct TakersOfMeans {
  using type = TypeList<>;
};
template <class Tuple, class F>
struct TakersIn;
template <class F>
struct TakersIn<std::tuple<>, F> {
  using type = TypeList<>;
};
template <class C, class... Cs, class F>
struct TakersIn<std::tuple<C, Cs...>, F> {
  using type = typename Joined<typename TakersOfMeans<C, F>::type,
                               typename TakersIn<std::tuple<Cs...>, F>::type>::type;
};
template <class C, class F>
  requires TakesMeans<C, F>
struct TakersOfMeans<C, F> {
  using type = TypeList<C>;
};
template <class C, class F>
  requires(!TakesMeans<C, F> &&
           requires(C const& c) { std::tuple_size<decltype(c.criteria)>::value; })
struct TakersOfMeans<C, F> : TakersIn<decltype(C::criteria), F> {};

template <class C, class List>
inline constexpr int times_in = 0;
template <class C, class... Cs>
inline constexpr int times_in<C, TypeList<Cs...>> = (0 + ... + (std::same_as<C, Cs> ? 1 : 0));

/// The first criterion of type Wanted in a criterion.
template <class Wanted, class C>
Wanted const* find_criterion(C const& criterion) {
  if constexpr (std::same_as<Wanted, C>) {
    return &criterion;
  } else if constexpr (requires { std::tuple_size<decltype(criterion.criteria)>::value; }) {
    Wanted const* found = nullptr;
    std::apply(
        [&](auto const&... parts) {
          ((found = found != nullptr ? found : find_criterion<Wanted>(parts)), ...);
        },
        criterion.criteria);
    return found;
  } else {
    return nullptr;
  }
}

/// The value of a criterion, found beforehand where it takes means.
template <class C, class State>
PLIANT_HOST_DEVICE auto value_of(C const& criterion, State const& e) {
  if constexpr (TakesMeans<C, typename State::formulation>)
    return e.template found<C>();
  else
    return criterion(e);
}
}  // namespace detail

}  // namespace pliant

#pragma once

#include <pliant/adaptation/estimator/law_discrepancy.hpp>
#include <pliant/adaptation/estimator/quadrature_discrepancy.hpp>

namespace pliant {

namespace detail {
/// What a criterion would see if the element were in another group, but for what belongs to the present one.
template <class Context>
struct ContextInGroup {
  Context const& context;

  template <class To>
  PLIANT_HOST_DEVICE decltype(auto) law_of() const {
    return context.template law_of<To>();
  }
  template <class F>
  PLIANT_HOST_DEVICE auto young_of() const {
    return context.template young_of<F>();
  }
  PLIANT_HOST_DEVICE auto origin() const { return context.origin(); }
  template <class C, class S>
  PLIANT_HOST_DEVICE S found() const {
    return not_a_number<S>();
  }
};

/// Discrepancy<To> as it would be in each of the groups Fs, in whatever group the element is.
template <class To, class... Fs>
struct Discrepancies {
  static constexpr int values = int{sizeof...(Fs)};
  static constexpr bool reads_young = true;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    static_assert((std::same_as<typename Fs::element, typename To::element> && ...),
                  "Discrepancy<To>: To is a formulation on the same element");
    auto found = of_laws(e, law_in<To>(e), law_in<Fs>(e)...);
    int k = 0;
    auto const complete = [&]<class F>(std::type_identity<F>) PLIANT_INLINE {
      found[k] = T(0.5) * found[k] / S(e.context.template young_of<F>()) + of_quadrature<F>(e);
      ++k;
    };
    (complete(std::type_identity<Fs>{}), ...);
    return found;
  }

 private:
  using First = std::tuple_element_t<0, std::tuple<Fs...>>;
  static constexpr bool share_points =
      (std::same_as<typename Fs::quadrature, typename First::quadrature> && ...);

  template <class F, class State>
  PLIANT_HOST_DEVICE static decltype(auto) law_in(State const& e) {
    if constexpr (std::same_as<F, typename State::formulation>)
      return (e.law);
    else
      return e.template law_of<F>();
  }
  template <class State, class Law, class... Laws>
  PLIANT_HOST_DEVICE static auto of_laws(State const& e, Law const& to, Laws const&... laws) {
    if constexpr (share_points)
      return squared_differences<First>(e, to, laws...);
    else
      return Vector<typename State::scalar, values>{{{squared_differences<Fs>(e, to, laws)[0]}...}};
  }
  template <class F, class State>
  PLIANT_HOST_DEVICE static auto of_quadrature(State const& e) {
    using S = typename State::scalar;
    if constexpr (std::same_as<typename F::quadrature, typename To::quadrature>) {
      return S(0);
    } else {
      auto const& law = law_in<F>(e);
      using Context = ContextInGroup<std::remove_cvref_t<decltype(e.context)>>;
      Context const context{e.context};
      return QuadratureDiscrepancy<
          Formulation<typename F::element, typename To::quadrature, F::template law>>{}(
          StateInBody<F, std::remove_cvref_t<decltype(law)>, S, Context>{
              state_of<F>(law, e.rest, e.u), context});
    }
  }
};
}  // namespace detail

/// What an element's formulation gets wrong beside the Group<To>, J: LawDiscrepancy<To> at the points of its own rule,
/// and, where To has another rule or scheme, QuadratureDiscrepancy beside that under its own law. Zero for To itself.
/// Where law and rule differ, the two are added as if independent: the energy of a sum of errors is at most twice the
/// sum of their energies. To is a formulation of the same element; neither has internal variables that the other has
/// not.
template <class To>
struct Discrepancy {
  static constexpr Unit unit = Unit::joule;
  static constexpr bool reads_young = true;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using F = typename State::formulation;
    if constexpr (std::same_as<F, To>)
      return typename State::scalar(0);
    else
      return detail::Discrepancies<To, F>{}(e)[0];
  }
};

}  // namespace pliant

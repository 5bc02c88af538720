#pragma once

#include <pliant/adaptation/estimator/law_discrepancy.hpp>
#include <pliant/adaptation/estimator/quadrature_discrepancy.hpp>

namespace pliant {

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
    using S = typename State::scalar;
    static_assert(std::same_as<typename F::element, typename To::element>,
                  "Discrepancy<To>: To is a formulation on the same element");
    if constexpr (std::same_as<F, To>)
      return S(0);
    else if constexpr (std::same_as<typename F::quadrature, typename To::quadrature>)
      return LawDiscrepancy<To>{}(e);
    else
      return LawDiscrepancy<To>{}(e) +
             QuadratureDiscrepancy<
                 Formulation<typename F::element, typename To::quadrature, F::template law>>{}(e);
  }
};

namespace detail {
/// What a criterion would see if the element were in the group of another formulation.
template <class G, class Context>
struct ContextInGroup {
  Context const& context;

  template <class To>
  PLIANT_HOST_DEVICE decltype(auto) law_of() const {
    return context.template law_of<To>();
  }
  PLIANT_HOST_DEVICE auto young() const { return context.template young_of<G>(); }
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

/// Discrepancy<To> as it would be in the group of G, whatever group the element is in.
template <class G, class To>
struct DiscrepancyOf {
  static constexpr Unit unit = Unit::joule;
  static constexpr bool reads_young = true;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    if constexpr (std::same_as<typename State::formulation, G>) {
      return Discrepancy<To>{}(e);
    } else {
      auto const& law = e.template law_of<G>();
      using Context = ContextInGroup<G, std::remove_cvref_t<decltype(e.context)>>;
      Context const context{e.context};
      return Discrepancy<To>{}(StateInBody<G, std::remove_cvref_t<decltype(law)>, S, Context>{
          state_of<G>(law, e.rest, e.u), context});
    }
  }
};
}  // namespace detail

}  // namespace pliant

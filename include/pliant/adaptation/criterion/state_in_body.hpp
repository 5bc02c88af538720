#pragma once

#include <pliant/adaptation/criterion/neighbours.hpp>

namespace pliant {

/// What a criterion may look at besides the element itself. `Context` is of the rule that asks.
template <class F, class L, class S, class Context>
struct StateInBody : ElementState<F, L, S> {
  Context const& context;

  /// The law that the element would have in the group of another formulation.
  template <class To>
  PLIANT_HOST_DEVICE decltype(auto) law_of() const {
    return context.template law_of<To>();
  }
  /// Young's modulus of the element's own law at rest, Pa.
  PLIANT_HOST_DEVICE S young() const { return S(context.young()); }
  /// The middle of the nodes at rest, m.
  PLIANT_HOST_DEVICE Vector<S, F::dim> centroid() const {
    using T = builtin_scalar<S>;
    auto const origin = context.origin();
    Vector<S, F::dim> centre;
    for (int k = 0; k < F::dim; ++k) {
      S sum = this->rest(0, k);
      for (int a = 1; a < F::nodes; ++a) sum = sum + this->rest(a, k);
      centre[k] = T(1.0 / F::nodes) * sum + origin[k];
    }
    return centre;
  }
  /// The value of a criterion that takes means at nodes; NaN for elements that changed group since.
  template <class C>
  PLIANT_HOST_DEVICE S found() const {
    return context.template found<C, S>();
  }
};

namespace detail {
/// The law that a criterion finds in the state of an element of a formulation.
template <class F, class T>
using LawInKernels =
    std::remove_cvref_t<decltype(std::declval<GroupLaws<T, F> const&>().template law<0>(
        OneElement{}))>;

/// A context to ask criteria whether they can be called.
template <class F>
struct ContextProbe {
  void const* none = nullptr;
  template <class To>
  PLIANT_HOST_DEVICE LawInKernels<To, double> const& law_of() const {
    return *static_cast<LawInKernels<To, double> const*>(none);
  }
  PLIANT_HOST_DEVICE double young() const { return 1; }
  template <class G>
  PLIANT_HOST_DEVICE double young_of() const {
    return 1;
  }
  PLIANT_HOST_DEVICE Vector<double, F::dim> origin() const { return {}; }
  template <class C, class S>
  PLIANT_HOST_DEVICE S found() const {
    return S(0);
  }
};
template <class F>
using StateProbe = StateInBody<F, LawInKernels<F, double>, double, ContextProbe<F>>;
}  // namespace detail

}  // namespace pliant

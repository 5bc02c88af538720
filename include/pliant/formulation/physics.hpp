#pragma once

#include <pliant/formulation/mass.hpp>
#include <pliant/formulation/scheme/hourglass.hpp>
#include <pliant/formulation/scheme/mean_dilatation.hpp>
#include <pliant/formulation/scheme/pointwise.hpp>

// The physics of one element, as functions of its nodal values: positions at rest X and
// displacements u. Values in, values out; the scalar S may be float, double, a pack of elements or
// a dual number. Tables are static: a GPU then reads them from its memory, where a local one would be
// built on the stack of every thread.
namespace pliant {

namespace detail {
/// How a formulation goes from points to nodes.
template <class F, Geometry G>
using SchemeOf =
    std::conditional_t<std::same_as<typename F::quadrature, OnePoint>, HourglassControl<F>,
                       std::conditional_t<has_mean_dilatation<typename F::quadrature>,
                                          MeanDilatation<F, G>, Pointwise<F, G>>>;
template <class L>
struct ScalarOf;
template <template <class> class L, class T>
struct ScalarOf<L<T>> {
  using type = T;
};
}  // namespace detail

/// A law as the functions below take it for a formulation: itself, or with what its hourglass control
/// needs to know of it, or with what the time since its internal variables were committed makes of that (s;
/// 0: at once; infinite: at rest).
template <class F, class L>
auto prepared(L const& law, [[maybe_unused]] double step = 0) {
  if constexpr (LawWithInternalVariables<L>) {
    static_assert(!std::same_as<typename F::quadrature, OnePoint> &&
                      !has_mean_dilatation<typename F::quadrature>,
                  "laws with internal variables take quadratures whose points see their own "
                  "deformation: neither "
                  "OnePoint nor FBar");
    return law.over(step);
  } else if constexpr (std::same_as<typename F::quadrature, OnePoint>) {
    static_assert(PointLaw<L>, "OnePoint takes laws that are the same for all elements");
    using T = typename detail::ScalarOf<L>::type;
    auto shear = Tensor<T, F::dim>::zero();
    shear(0, 1) = T(1);
    return WithModulus<L, T>{law,
                             stress_tangent_product(law, Tensor<T, F::dim>::zero(), shear)(0, 1)};
  } else {
    return law;
  }
}

/// The strain energy W_E, J.
template <class F, Geometry G = Geometry::isoparametric, class L, class S>
PLIANT_HOST_DEVICE S energy(L const& law, Nodal<typename F::element, S> const& rest,
                            Nodal<typename F::element, S> const& u) {
  return detail::SchemeOf<F, G>::energy(law, rest, u);
}

/// The nodal forces F_E = −∂W_E/∂u = −Σ_q w_q P(H) cof J ∂N/∂ξ, N.
template <class F, Geometry G = Geometry::isoparametric, class L, class S>
PLIANT_HOST_DEVICE Nodal<typename F::element, S> force(L const& law,
                                                       Nodal<typename F::element, S> const& rest,
                                                       Nodal<typename F::element, S> const& u) {
  return detail::SchemeOf<F, G>::force(law, rest, u);
}

/// The change of the nodal forces under displacements du: −∂²W_E/∂u² du, N.
template <class F, Geometry G = Geometry::isoparametric, class L, class S>
PLIANT_HOST_DEVICE Nodal<typename F::element, S> tangent_product(
    L const& law, Nodal<typename F::element, S> const& rest, Nodal<typename F::element, S> const& u,
    Nodal<typename F::element, S> const& du) {
  return detail::SchemeOf<F, G>::tangent_product(law, rest, u, du);
}

/// Whether the stiffness matrix of an element is too large for each thread of a GPU to have one: of Hex20 and Hex27.
template <class F>
inline constexpr bool has_large_stiffness = F::nodes * F::dim > 48;

/// The stiffness matrix K = ∂²W_E/∂u², N/m; rows and columns run over (node, direction). Large and
/// seldom called, so kept out of line; constexpr is what lets device code call it.
template <class F, class L, class S>
[[gnu::noinline]] constexpr Tensor<S, F::nodes * F::dim> stiffness(
    L const& law, Nodal<typename F::element, S> const& rest,
    Nodal<typename F::element, S> const& u) {
  using Scheme = detail::SchemeOf<F, Geometry::isoparametric>;
  if constexpr (requires { Scheme::stiffness(law, rest, u); }) {
    return Scheme::stiffness(law, rest, u);
  } else {
    constexpr int n = F::nodes * F::dim;
    Tensor<S, n> k;
    for (int column = 0; column < n; ++column) {
      auto du = Nodal<typename F::element, S>::zero();
      du(column / F::dim, column % F::dim) = S(1);
      auto const df = tangent_product<F>(law, rest, u, du);
      for (int row = 0; row < n; ++row) k(row, column) = -df(row / F::dim, row % F::dim);
    }
    return k;
  }
}

}  // namespace pliant

#pragma once

#include <utility>

#include <pliant/backend/dispatch.hpp>
#include <pliant/element/lattice.hpp>
#include <pliant/quadrature/tensor_rule.hpp>

namespace pliant {

/// Where the fluxes of a point kernel are summed: the quadrature points of an element.
template <Element E, class Q>
struct PointsOf {
  using element = E;
  using quadrature = Q;
};

namespace detail {
template <class P>
inline constexpr bool are_product_points = false;
template <TensorElement E, class Q>
inline constexpr bool are_product_points<PointsOf<E, Q>> = is_tensor_rule<Q, typename E::cell>;

template <class Kernel, int... G>
constexpr bool has_product_points(std::integer_sequence<int, G...>) {
  if constexpr (requires { (std::declval<typename Kernel::template points<G>>(), ...); })
    return (are_product_points<typename Kernel::template points<G>> && ...);
  else
    return false;
}
}  // namespace detail

/// A kernel for accumulate that gives Σ_q Σ_k t_ik ∂N_a/∂ξ_k: `points<g>` tells the points, a PointsOf, and
/// flux(GroupNumber<g>, q, weight, ∂v/∂ξ...) const gives t at point q from the slopes (dim, dim) of the fields there, with
/// `own` before q if the kernel has reads_elements = true. A backend may share the points of an element among threads.
template <class Kernel, int Groups>
concept PointKernel = detail::has_product_points<Kernel>(std::make_integer_sequence<int, Groups>());

/// kernel.flux(group, ...), with `own` for a kernel that asks.
template <class Kernel, class Group, class Own, class... V>
PLIANT_HOST_DEVICE auto flux_at(Kernel const& kernel, Group group, Own const& own, V const&... v) {
  if constexpr (ReadsElements<Kernel>)
    return kernel.flux(group, own, v...);
  else
    return kernel.flux(group, v...);
}

}  // namespace pliant

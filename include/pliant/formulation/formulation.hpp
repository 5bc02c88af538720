#pragma once

#include <pliant/element/element.hpp>
#include <pliant/formulation/scheme/f_bar.hpp>
#include <pliant/law/law.hpp>

namespace pliant {

namespace detail {
/// Whether as many strains are looked at as there are ways to deform the element. (That no deformation
/// escapes them is tested for every formulation that passes.)
template <Element E, class Q>
constexpr bool enough_points() {
  constexpr int strains = E::dim == 2 ? 3 : 6, rigid_motions = strains;
  constexpr int points = Tabulation<E, Q, double>::count,
                needed = E::nodes * E::dim - rigid_motions;
  if constexpr (requires { Q::controls_hourglasses; })
    return true;
  else if constexpr (has_mean_dilatation<Q> && E::dim == 3)  // deviators, and a dilatation
    return points * (strains - 1) + 1 >= needed;
  else
    return points * strains >= needed;
}
}  // namespace detail

/// Element × quadrature × law: the thing that has forces. A type only; the parameters of the law
/// live in the group.
template <Element E, class Q, template <class> class L>
  requires QuadratureOn<Q, typename E::cell> && Law<L<double>>
struct Formulation {
  static_assert(
      detail::enough_points<E, Q>(),
      "this quadrature has too few points for this element: some deformations would meet no "
      "resistance (zero-energy modes). Take a rule with more points, or OnePoint, which "
      "controls them on Quad4 and Hex8");
  using element = E;
  using quadrature = Q;
  template <class T>
  using law = L<T>;
  static constexpr int dim = E::dim, nodes = E::nodes;
  static constexpr int points = Tabulation<E, Q, double>::count;
  /// As its law does; F-bar asks J of all points of an element to have one sign.
  static constexpr bool takes_inversion =
      pliant::takes_inversion<L<double>> &&
      (!has_mean_dilatation<Q> || EnergyIn<L<double>, StrainInvariants>);
};

}  // namespace pliant

#pragma once

#include <type_traits>
#include <utility>

#include <pliant/law/invariants/invariants.hpp>

// Sets of invariants in which a law with fibres may write its energy. Its point has `fibres`, an array
// of what stands for each: a direction, a unit vector or 0, unless the set says otherwise. The energies
// along all of them add up. Made from the Green strain E = (FᵀF − I)/2; in 2D the strain is plane.
namespace pliant {

namespace detail {

/// E a, its components in the 2 or 3 dimensions.
template <class S, int Dim, class C>
PLIANT_HOST_DEVICE Vector<S, Dim> strain_along(Tensor<S, Dim> const& e, Vector<C, 3> const& a) {
  Vector<S, Dim> product;
  for (int i = 0; i < Dim; ++i) {
    product[i] = e(i, 0) * a[0];
    for (int j = 1; j < Dim; ++j) product[i] = product[i] + e(i, j) * a[j];
  }
  return product;
}
/// a·v, of the 2 or 3 components of v.
template <class S, int Dim, class C>
PLIANT_HOST_DEVICE S along(Vector<C, 3> const& a, Vector<S, Dim> const& v) {
  S sum = v[0] * a[0];
  for (int i = 1; i < Dim; ++i) sum = sum + v[i] * a[i];
  return sum;
}
/// Adds ∂W/∂E of the energy along one fibre.
template <class Family, class L, class S, int Dim, class Fibre>
PLIANT_HOST_DEVICE void add_stress_along(Tensor<S, Dim>& second, L const& law, Fibre const& a,
                                         Tensor<S, Dim> const& e) {
  slopes_of<S>(law, Family::of(e, a)).add_second_stress(second, e, a);
}

template <class L>
using FibresOf = std::make_index_sequence<std::extent_v<decltype(L::fibres)>>;

template <class Family, class L, class S, int Dim, std::size_t... K>
PLIANT_HOST_DEVICE S energy_along_fibres(L const& law, Tensor<S, Dim> const& h,
                                         std::index_sequence<K...>) {
  auto const e = GreenInvariants<S>::strain(h);
  return (law.energy(Family::of(e, law.fibres[K])) + ...);
}
/// P = F S with the second Piola-Kirchhoff stress S = Σ ∂W/∂E.
template <class Family, class L, class S, int Dim, std::size_t... K>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_along_fibres(L const& law, Tensor<S, Dim> const& h,
                                                      std::index_sequence<K...>) {
  auto const e = GreenInvariants<S>::strain(h);
  auto second = Tensor<S, Dim>::zero();
  (add_stress_along<Family>(second, law, law.fibres[K], e), ...);
  return second + h * second;
}

}  // namespace detail

/// How a family of fibres is stretched that spread about a direction a: ε = H:(C − I) with the structure
/// tensor H = d I + (1 − 3d) a⊗a of their dispersion d, which stands for the fibre. (Gasser, Ogden and
/// Holzapfel, J. R. Soc. Interface 3 (2006) 15.) For d = 0, ε = a·C a − 1.
template <class S>
struct FibreStretch {
  static constexpr int count = 1;
  S strain;  // ε

  template <class T>
  using rebind = FibreStretch<T>;

  /// 2 H:E; 2 H is the same at all points of an element.
  template <class C, int Dim>
  PLIANT_HOST_DEVICE static FibreStretch of(Tensor<S, Dim> const& e, Tensor<C, 3> const& H) {
    S sum = e(0, 0) * (2 * H(0, 0));
    for (int i = 1; i < Dim; ++i) {
      sum = sum + e(i, i) * (2 * H(i, i));
      for (int j = 0; j < i; ++j) sum = sum + (e(i, j) + e(j, i)) * (2 * H(i, j));
    }
    return {sum};
  }
  /// Adds ∂W/∂E, where this is the derivative of W by ε.
  template <class C, int Dim>
  PLIANT_HOST_DEVICE void add_second_stress(Tensor<S, Dim>& second, Tensor<S, Dim> const&,
                                            Tensor<C, 3> const& H) const {
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j <= i; ++j)
        second(i, j) = second(j, i) = second(i, j) + strain * (2 * H(i, j));
  }
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static S energy_of(L const& law, Tensor<S, Dim> const& h) {
    return detail::energy_along_fibres<FibreStretch>(law, h, detail::FibresOf<L>{});
  }
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress_of(L const& law, Tensor<S, Dim> const& h) {
    return detail::stress_along_fibres<FibreStretch>(law, h, detail::FibresOf<L>{});
  }
};

/// The strain along a fibre a, about it, and between both, in any frame with s and n across a: E_aa;
/// E_ss² + E_nn² + 2 E_sn²; E_as² + E_an². Where a is 0 the second is E:E and the others are 0.
template <class S>
struct FibreStrain {
  static constexpr int count = 3;
  S along, across, shear;

  template <class T>
  using rebind = FibreStrain<T>;

  /// In no frame: E_as² + E_an² = |E a|² − E_aa², and E:E has the rest.
  template <class C, int Dim>
  PLIANT_HOST_DEVICE static FibreStrain of(Tensor<S, Dim> const& e, Vector<C, 3> const& a) {
    auto const line = detail::strain_along(e, a);
    S const aa = detail::along(a, line), shear = dot(line, line) - square(aa);
    return {aa, dot(e, e) - square(aa) - (shear + shear), shear};
  }
  /// Adds ∂W/∂E, where these are the derivatives of W by the invariants.
  template <class C, int Dim>
  PLIANT_HOST_DEVICE void add_second_stress(Tensor<S, Dim>& second, Tensor<S, Dim> const& e,
                                            Vector<C, 3> const& a) const {
    auto side = detail::strain_along(e, a);
    S const round = across + across, mixed = shear - round;
    S const half = along / 2 + (across - shear) * detail::along(a, side);
    for (int i = 0; i < Dim; ++i) side[i] = mixed * side[i] + half * a[i];
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j)
        second(i, j) = second(j, i) =
            second(i, j) + round * e(i, j) + (side[i] * a[j] + side[j] * a[i]);
  }
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static S energy_of(L const& law, Tensor<S, Dim> const& h) {
    return detail::energy_along_fibres<FibreStrain>(law, h, detail::FibresOf<L>{});
  }
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress_of(L const& law, Tensor<S, Dim> const& h) {
    return detail::stress_along_fibres<FibreStrain>(law, h, detail::FibresOf<L>{});
  }
};

}  // namespace pliant

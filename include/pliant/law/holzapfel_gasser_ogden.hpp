#pragma once

#include <pliant/law/fibre.hpp>

namespace pliant {

/// Holzapfel-Gasser-Ogden, of artery walls: a neo-Hookean matrix and two families of fibres that
/// spread about their directions a₁ and a₂, W = μ/2 (Ī₁ − 3) + κ/2 (J − 1)² + k₁/(2 k₂) Σ (exp(k₂
/// ⟨ε⟩²) − 1), ε = d (I₁ − 3) + (1 − 3d) (I₄ − 1), I₄ = a·C a. A family that is shortened, ε < 0,
/// carries nothing: stress is continuous there, its tangent is not. For J > 0. The fibres feel the
/// whole C, not its isochoric part, which would let them swell (Nolan, Gower, Destrade, Ogden and
/// McGarry, J. Mech. Behav. Biomed. Mater. 39 (2014) 48). The directions are the values of an
/// element: two times three components, of any length; a family whose components are 0 is not
/// there. (Gasser, Ogden and Holzapfel, J. R. Soc. Interface 3 (2006) 15.)
template <class T>
struct HolzapfelGasserOgden {
  T mu;          // shear modulus of the matrix, Pa: positive
  T k1;          // stiffness of a family, Pa: not negative
  T k2;          // its stiffening, positive
  T dispersion;  // d: 0 where all fibres are parallel, 1/3 where they have no direction
  T bulk;        // κ, Pa: positive

  static constexpr int element_values = 6;
  static constexpr bool takes_inversion = false;

  void check() const {
    detail::demand(mu > 0, "Holzapfel-Gasser-Ogden's mu", mu, "be positive (in Pa)");
    detail::demand(k1 >= 0, "Holzapfel-Gasser-Ogden's k1", k1, "not be negative (in Pa)");
    detail::demand(k2 > 0, "Holzapfel-Gasser-Ogden's k2", k2, "be positive");
    detail::demand(dispersion >= 0 && dispersion <= T(1.0 / 3),
                   "Holzapfel-Gasser-Ogden's dispersion", dispersion, "be in [0, 1/3]");
    detail::demand(bulk > 0, "Holzapfel-Gasser-Ogden's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// The law of an element with its directions.
  template <class S>
  struct Along {
    HolzapfelGasserOgden law;
    T scale;  // k₁/(2 k₂), Pa
    Tensor<S, 3> fibres[2];

    static constexpr bool takes_inversion = HolzapfelGasserOgden::takes_inversion;

    template <class V>
    PLIANT_HOST_DEVICE V energy(IsochoricInvariants<V> const& i) const {
      return law.mu / 2 * i.I1_minus_3 + law.bulk / 2 * square(i.J_minus_1);
    }
    template <class V>
    PLIANT_HOST_DEVICE V energy(FibreStretch<V> const& i) const {
      return scale * expm1(law.k2 * square_of_positive(i.strain));
    }
  };
  template <class S>
  PLIANT_HOST_DEVICE Along<S> at(Vector<S, 6> const& a) const {
    return {*this,
            k1 / (2 * k2),
            {detail::structure(dispersion, Vector<S, 3>{{{a[0]}, {a[1]}, {a[2]}}}),
             detail::structure(dispersion, Vector<S, 3>{{{a[3]}, {a[4]}, {a[5]}}})}};
  }
};

}  // namespace pliant

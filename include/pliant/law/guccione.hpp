#pragma once

#include <pliant/law/fibre.hpp>

namespace pliant {

/// Guccione's law of heart muscle, stiffer along its fibres: W = c/2 (e^Q − 1) + κ/2 (J − 1)² with
/// Q = b_f E_ff² + b_t (E_ss² + E_nn² + 2 E_sn²) + 2 b_fs (E_fs² + E_fn²) in the components of the
/// Green strain along the fibre f and any two directions across. The fibre is the value of an
/// element: three components, of any length; none where they are 0, and then Q = b_t E:E. Softens
/// under compression; κ far above c makes muscle nearly incompressible. Defined for every F. (Guccione, McCulloch and
/// Waldman, Journal of Biomechanical Engineering 113 (1991) 42.)
template <class T>
struct Guccione {
  T c;                            // Pa: positive
  T fibre, transverse, shearing;  // b_f, b_t, b_fs: positive
  T bulk;                         // κ, Pa: not negative

  static constexpr int element_values = 3;
  static constexpr bool takes_inversion = true;

  void check() const {
    detail::demand(c > 0, "Guccione's c", c, "be positive (in Pa)");
    detail::demand(fibre > 0, "Guccione's exponent along fibres", fibre, "be positive");
    detail::demand(transverse > 0, "Guccione's exponent across fibres", transverse, "be positive");
    detail::demand(shearing > 0, "Guccione's exponent of shear", shearing, "be positive");
    detail::demand(bulk >= 0, "Guccione's bulk modulus", bulk, "not be negative (in Pa)");
  }
  /// The law of an element with its direction.
  template <class S>
  struct Along {
    Guccione law;
    Vector<S, 3> fibres[1];

    static constexpr bool takes_inversion = Guccione::takes_inversion;

    template <class V>
    PLIANT_HOST_DEVICE V energy(FibreStrain<V> const& E) const {
      V const Q =
          law.fibre * square(E.along) + law.transverse * E.across + 2 * law.shearing * E.shear;
      return law.c / 2 * expm1(Q);
    }
    template <class V>
    PLIANT_HOST_DEVICE V energy(VolumeChange<V> const& i) const {
      return law.bulk / 2 * square(i.J_minus_1);
    }
  };
  template <class S>
  PLIANT_HOST_DEVICE Along<S> at(Vector<S, 3> const& f) const {
    return {*this, {detail::normalised(f)}};
  }
};

}  // namespace pliant

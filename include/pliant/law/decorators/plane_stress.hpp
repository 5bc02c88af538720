#pragma once

#include <pliant/law/hooke.hpp>
#include <pliant/law/law.hpp>

namespace pliant {
namespace detail {

/// A law of solids in a sheet that is free to change its thickness: P₃₃ = 0.
template <class L>
struct Sheet {
  L solid;

  static constexpr bool takes_inversion = false;

  void check() const { detail::check_parameters(solid); }
  /// F₃₃ − 1 at the in-plane displacement gradient h, by Newton's method on ln F₃₃. It starts from
  /// F₃₃ = J₂^(−r), J₂ = det F in the plane, r the law's own ratio at rest, which is exact for
  /// λ/2 (ln J)² and in the limit of incompressibility. After 6 steps all laws here are exact to
  /// rounding at stretches of 0.6 to 1.6; after 8 to 1e-9 at 0.37 to 2.7, up to ν = 0.4995. NaN for
  /// J₂ ≤ 0.
  template <class S>
  PLIANT_HOST_DEVICE S thickening(Tensor<S, 2> const& h) const {
    constexpr int steps = sizeof(builtin_scalar<S>) == 4 ? 6 : 8;
    auto const at_rest = stress(solid, thickness_varies(Tensor<S, 2>::zero(), S(0)));
    S const ratio = (at_rest(0, 0).derivative[0] + at_rest(1, 1).derivative[0]) /
                    (2 * at_rest(2, 2).derivative[0]);
    S const flattest = S(builtin_scalar<S>(-0.95));  // what a flattened element starts from
    S const J2_minus_1 = determinant_less_one(h);
    S z = expm1(-ratio * log1p(max(J2_minus_1, flattest)));
    for (int step = 0; step < steps; ++step) {
      Dual<S, 1> const p33 = stress(solid, thickness_varies(h, z))(2, 2);
      S const F33 = 1 + z, slope = p33.value + F33 * p33.derivative[0];
      z = z + F33 * expm1(-p33.value / slope);
    }
    return select(S(0) < 1 + J2_minus_1, z, not_a_number<S>());
  }
  /// One more step makes the derivative: ∂F₃₃/∂F = −(∂P₃₃/∂F)/(∂P₃₃/∂F₃₃).
  template <class U, int N>
  PLIANT_HOST_DEVICE Dual<U, N> thickening(Tensor<Dual<U, N>, 2> const& h) const {
    Tensor<U, 2> values;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) values(i, j) = h(i, j).value;
    U const z = thickening(values);
    Dual<U, N> const p33 = stress(solid, with_thickness(h, Dual<U, N>(z)))(2, 2);
    Dual<U, 1> const p33_by_z = stress(solid, thickness_varies(values, z))(2, 2);
    return p33.chain(z, -1 / p33_by_z.derivative[0]);
  }

  template <class S>
  PLIANT_HOST_DEVICE S energy(Tensor<S, 2> const& h) const {
    return energy_density(solid, with_thickness(h, thickening(h)));
  }
  /// The energy does not change with F₃₃ where P₃₃ = 0: P is that of the solid.
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 2> stress(Tensor<S, 2> const& h) const {
    auto const p = stress(solid, with_thickness(h, thickening(h)));
    return {{{p(0, 0), p(0, 1)}, {p(1, 0), p(1, 1)}}};
  }

 private:
  template <class S>
  PLIANT_HOST_DEVICE static Tensor<S, 3> stress(L const& solid, Tensor<S, 3> const& h) {
    return pliant::stress(solid, h);
  }
  template <class S>
  PLIANT_HOST_DEVICE static Tensor<S, 3> with_thickness(Tensor<S, 2> const& h, S const& z) {
    Tensor<S, 3> in_3d = in_space(h);
    in_3d(2, 2) = z;
    return in_3d;
  }
  template <class S>
  PLIANT_HOST_DEVICE static Tensor<Dual<S, 1>, 3> thickness_varies(Tensor<S, 2> const& h,
                                                                   S const& z) {
    Tensor<Dual<S, 1>, 2> constants;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) constants(i, j) = Dual<S, 1>(h(i, j));
    return with_thickness(constants, Dual<S, 1>::variable(z, 0));
  }
};

/// Hooke's law in closed form: λ turns into 2λμ/(λ + 2μ).
template <class T>
struct Sheet<Hooke<T>> {
  Hooke<T> solid;

  static constexpr bool takes_inversion = true;

  void check() const { detail::check_parameters(solid); }
  template <class S>
  PLIANT_HOST_DEVICE S thickening(Tensor<S, 2> const& h) const {
    return -solid.lambda / (solid.lambda + 2 * solid.mu) * trace(h);
  }
  template <class S>
  PLIANT_HOST_DEVICE S energy(Tensor<S, 2> const& h) const {
    return in_plane().energy(StrainInvariants<S>::of(h));
  }
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 2> stress(Tensor<S, 2> const& h) const {
    return pliant::stress(in_plane(), h);
  }

 private:
  PLIANT_HOST_DEVICE Hooke<T> in_plane() const {
    return {2 * solid.lambda * solid.mu / (solid.lambda + 2 * solid.mu), solid.mu};
  }
};

template <LawPerElement L>
struct Sheet<L> {
  L solid;
  static constexpr int element_values = L::element_values;
  static constexpr bool takes_inversion = false;

  void check() const { detail::check_parameters(solid); }
  template <class S>
  PLIANT_HOST_DEVICE auto at(Vector<S, element_values> const& values) const {
    return Sheet<decltype(solid.at(values))>{solid.at(values)};
  }
};

}  // namespace detail

/// Plane stress, of sheets free to change their thickness, where two dimensions else mean plane
/// strain: Formulation<Quad4, Gauss<2>, PlaneStress<NeoHookean>::law>. Forces are per thickness at
/// rest. Of any law in whose state h₁₃ = h₂₃ = 0 there is no out-of-plane shear stress: isotropic
/// ones, and those of fibres within the plane or normal to it. Costs 9 tangent products of the law,
/// Hooke's none. All sheets but Hooke's are for J > 0 in the plane, whatever their law, and NaN elsewhere.
/// Where no F₃₃ > 0 makes P₃₃ = 0 (Saint Venant-Kirchhoff, Fung and corotated sheets at large stretch)
/// the result means nothing.
template <template <class> class L>
struct PlaneStress {
  template <class T>
  struct law : detail::Sheet<L<T>> {
    static law from(Elastic const& m)
      requires LawFromElastic<L<T>>
    {
      return {{L<T>::from(m)}};
    }
  };
};

}  // namespace pliant

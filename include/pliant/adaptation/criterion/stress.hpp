#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/formulation/point_stress.hpp>

// How much an element is strained and stressed, in the middle of its cell.
namespace pliant {

/// The equivalent stress √(3/2 s:s) of von Mises, Pa, of the deviator s of Cauchy's stress P Fᵀ/J (of P, under laws
/// of small strain, whose stress is that). In plane strain with the stress across the plane, in plane stress
/// without. NaN where an element is inverted.
struct VonMises {
  static constexpr Unit unit = Unit::pascal;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    decltype(auto) law = point_law(e.law, 0);
    using L = std::remove_cvref_t<decltype(law)>;
    auto const h = e.gradient();
    Tensor<S, 3> p;
    if constexpr (SolidLaw<L>)
      p = stress(law, in_space(h));
    else
      p = in_space(stress(law, h));  // a sheet's
    auto sigma = p;
    if constexpr (!detail::OfSmallStrain<L>) {
      auto const in_3d = in_space(h);
      sigma = reciprocal(positive_or_nan(S(1) + determinant_less_one(in_3d))) *
              (p + p * transpose(in_3d));
    }
    S const mean = T(1.0 / 3) * trace(sigma);
    for (int i = 0; i < 3; ++i) sigma(i, i) = sigma(i, i) - mean;
    return sqrt(T(1.5) * dot(sigma, sigma));
  }
};

/// The mean strain energy per rest volume, J/m³.
struct EnergyDensity {
  static constexpr Unit unit = Unit::joule_per_volume;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return energy<typename State::formulation>(e.law, e.rest, e.u) / e.volume();
  }
};

}  // namespace pliant

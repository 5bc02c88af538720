#pragma once

#include <cmath>

#include <pliant/law/ranges.hpp>

namespace pliant {

/// What an engineer knows of an isotropic material. Laws take their parameters from it such that
/// all agree with Hooke's law at small strain.
struct Elastic {
  double young;    // Young's modulus E, Pa
  double poisson;  // Poisson's ratio ν, in (−1, 0.5)
  double density;  // ρ, kg/m³ (kg/m² per unit thickness in 2D)

  double lame_lambda() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }
  double lame_mu() const { return young / (2 * (1 + poisson)); }
  double bulk() const { return young / (3 * (1 - 2 * poisson)); }

  /// Throws Error when a value is impossible.
  Elastic const& checked() const {
    detail::demand(young > 0 && std::isfinite(young), "material: Young's modulus", young,
                   "be positive and finite (in Pa)");
    detail::demand(poisson > -1 && poisson < 0.5, "material: Poisson's ratio", poisson,
                   "be in (-1, 0.5)");
    detail::demand(density > 0 && std::isfinite(density), "material: density", density,
                   "be positive and finite (in kg/m^3)");
    return *this;
  }
};

}  // namespace pliant

#pragma once

#include <cmath>
#include <string>

#include <pliant/error.hpp>

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
    auto const refuse = [](std::string what, double value, std::string must) {
      throw Error("material: " + what + " is " + detail::text(value) + "; it must be " + must);
    };
    if (!(young > 0 && std::isfinite(young)))
      refuse("Young's modulus", young, "positive and finite (in Pa)");
    if (!(poisson > -1 && poisson < 0.5)) refuse("Poisson's ratio", poisson, "in (-1, 0.5)");
    if (!(density > 0 && std::isfinite(density)))
      refuse("density", density, "positive and finite (in kg/m^3)");
    return *this;
  }
};

}  // namespace pliant

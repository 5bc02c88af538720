#pragma once

#include <pliant/error.hpp>

// What a law's `check` asks of its parameters.
namespace pliant::detail {

/// Throws Error about a parameter unless the condition holds.
template <class T>
void demand(bool holds, char const* what, T value, char const* must) {
  if (!holds) throw Error(what, " is ", value, "; it must ", must);
}
/// Throws Error unless the law resists shear and, with its Lamé's parameters at rest, change of volume.
template <class T>
void demand_lame(char const* law, T lambda, T mu) {
  if (!(mu > 0)) throw Error(law, "'s mu is ", mu, "; it must be positive (in Pa)");
  if (!(lambda > -2 * mu / 3))
    throw Error(law, "'s lambda is ", lambda, "; it must be above -2/3 mu, here ", -2 * mu / 3,
                " (in Pa)");
}
/// Throws Error where a law finds its parameters impossible.
template <class L>
void check_parameters(L const& law) {
  if constexpr (requires { law.check(); }) law.check();
}

}  // namespace pliant::detail

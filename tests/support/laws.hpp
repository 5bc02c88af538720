#pragma once

#include <tuple>

#include "support/backends.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

/// λ = 3 Pa, μ = 2 Pa: the constants of REFERENCES, section 6.
inline constexpr double lame_lambda = 3, lame_mu = 2;
template <template <class> class L, class T = double>
inline constexpr L<T> law_of_section_6{T(lame_lambda), T(lame_mu)};

template <int Dim>
Tensor<double, Dim> diagonal(std::array<double, 3> const& entries) {
  auto h = Tensor<double, Dim>::zero();
  for (int i = 0; i < Dim; ++i) h(i, i) = entries[static_cast<std::size_t>(i)];
  return h;
}
template <int Dim>
double largest(Tensor<double, Dim> const& a) {
  double m = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) m = std::isnan(a(i, j)) ? NAN : std::max(m, std::abs(a(i, j)));
  return m;
}
/// A displacement gradient of a few tenths; J stays above 0.2.
template <int Dim>
Tensor<double, Dim> random_state(Random& random, double size = 0.25) {
  for (;;) {
    auto const h = random.tensor<Dim>(size);
    if (determinant_less_one(h) > -0.8) return h;
  }
}
/// A random rotation, from the axis and the angle that a random vector makes.
template <int Dim>
Tensor<double, Dim> random_rotation(Random& random) {
  double const a = 3 * random();
  if constexpr (Dim == 2) {
    return {{{std::cos(a), -std::sin(a)}, {std::sin(a), std::cos(a)}}};
  } else {
    Vector<double, 3> axis{{{random()}, {random()}, {random()}}};
    axis = 1 / norm(axis) * axis;
    auto r =
        std::cos(a) * Tensor<double, 3>::identity() + (1 - std::cos(a)) * (axis * transpose(axis));
    for (int k = 0; k < 3; ++k) {
      r((k + 2) % 3, (k + 1) % 3) += std::sin(a) * axis[k];
      r((k + 1) % 3, (k + 2) % 3) -= std::sin(a) * axis[k];
    }
    return r;
  }
}

/// Calls visit(law, dimension) for each law in 2D and 3D, each in a section of its own.
template <class Visit>
void on_each_law(Visit const& visit) {
  auto const one = [&](char const* name, auto law) {
    DYNAMIC_SECTION(name << " in 2D") { visit(law, std::integral_constant<int, 2>{}); }
    DYNAMIC_SECTION(name << " in 3D") { visit(law, std::integral_constant<int, 3>{}); }
  };
  one("Hooke", law_of_section_6<Hooke>);
  one("SaintVenantKirchhoff", law_of_section_6<SaintVenantKirchhoff>);
  one("NeoHookean", law_of_section_6<NeoHookean>);
}

}  // namespace pliant::test

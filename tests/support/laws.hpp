#pragma once

#include <functional>

#include <pliant/law/arruda_boyce.hpp>
#include <pliant/law/corotated.hpp>
#include <pliant/law/fung.hpp>
#include <pliant/law/gent.hpp>
#include <pliant/law/guccione.hpp>
#include <pliant/law/holzapfel_gasser_ogden.hpp>
#include <pliant/law/hooke.hpp>
#include <pliant/law/isochoric_neo_hookean.hpp>
#include <pliant/law/mooney_rivlin.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/law/ogden.hpp>
#include <pliant/law/saint_venant_kirchhoff.hpp>
#include <pliant/law/simo_neo_hookean.hpp>
#include <pliant/law/stable_neo_hookean.hpp>
#include <pliant/law/yeoh.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

/// λ = 3 Pa, μ = 2 Pa (E = 5.2 Pa, ν = 0.3): the constants of REFERENCES, section 6.
template <template <class> class L, class T = double>
L<T> const law_of_section_6 = L<T>::from({.young = 5.2, .poisson = 0.3, .density = 1});

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
    for (int j = 0; j < Dim; ++j)
      m = std::isfinite(a(i, j)) ? std::max(m, std::abs(a(i, j))) : INFINITY;
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

/// What a law leaves alone, and whether it is Hooke's at small strain.
struct Kind {
  bool objective = true, isotropic = true, like_hooke = true;
};

/// A law in one dimension and one precision, whichever it is: a suite then compiles once for all.
template <int Dim, class T = double>
struct AnyLaw {
  Kind kind;
  std::function<T(Tensor<T, Dim> const&)> energy;
  std::function<Tensor<T, Dim>(Tensor<T, Dim> const&)> stress;
  std::function<Tensor<T, Dim>(Tensor<T, Dim> const&, Tensor<T, Dim> const&)> change;
};
template <int Dim, class T>
T energy_density(AnyLaw<Dim, T> const& law, Tensor<T, Dim> const& h) {
  return law.energy(h);
}
template <int Dim, class T>
Tensor<T, Dim> stress(AnyLaw<Dim, T> const& law, Tensor<T, Dim> const& h) {
  return law.stress(h);
}
template <int Dim, class T>
Tensor<T, Dim> stress_tangent_product(AnyLaw<Dim, T> const& law, Tensor<T, Dim> const& h,
                                      Tensor<T, Dim> const& dh) {
  return law.change(h, dh);
}

/// What a suite asks of laws; the less, the sooner it is compiled.
enum class Ask { energy_and_stress, stress_and_tangent };

template <Ask ask, int Dim, class T, class L>
AnyLaw<Dim, T> any_law(L const& law, Kind kind) {
  using H = Tensor<T, Dim>;
  AnyLaw<Dim, T> any{kind, {}, {}, {}};
  any.stress = [law](H const& h) { return pliant::stress(law, h); };
  if constexpr (ask == Ask::energy_and_stress)
    any.energy = [law](H const& h) { return pliant::energy_density(law, h); };
  else
    any.change = [law](H const& h, H const& dh) {
      return pliant::stress_tangent_product(law, h, dh);
    };
  return any;
}

/// Calls visit(make, name, kind) for each law, where make(T()) is the law in that precision.
template <class Visit>
void on_each_maker(Visit const& visit) {
  auto const plain = [&]<template <class> class L>(L<double> const&, char const* name,
                                                   Kind kind = {}) {
    visit([]<class T>(T) { return law_of_section_6<L, T>; }, name, kind);
  };
  plain(Hooke<double>{}, "Hooke", {.objective = false});
  plain(SaintVenantKirchhoff<double>{}, "SaintVenantKirchhoff");
  plain(NeoHookean<double>{}, "NeoHookean");
  plain(StableNeoHookean<double>{}, "StableNeoHookean");
  plain(IsochoricNeoHookean<double>{}, "IsochoricNeoHookean");
  plain(SimoNeoHookean<double>{}, "SimoNeoHookean");
  plain(MooneyRivlin<double>{}, "MooneyRivlin");
  plain(Fung<double>{}, "Fung");
  plain(Corotated<double>{}, "Corotated");
  plain(Ogden<double>{}, "Ogden");
  // The others with more than their usual stiffening, and fibres that are no axes.
  visit([]<class T>(T) { return Yeoh<T>::from({5.2, 0.3, 1}, 0.2, 0.1); }, "Yeoh", Kind{});
  visit([]<class T>(T) { return Gent<T>::from({5.2, 0.3, 1}, 10); }, "Gent", Kind{});
  visit([]<class T>(T) { return ArrudaBoyce<T>::from({5.2, 0.3, 1}, 1.5); }, "ArrudaBoyce", Kind{});
  Kind const fibrous{.isotropic = false, .like_hooke = false};
  visit(
      []<class T>(T) {
        return Guccione<T>{2, 4, 1, 2, 5}.at(Vector<T, 3>{{{3}, {4}, {1}}});
      },
      "Guccione", fibrous);
  visit(
      []<class T>(T) {
        Vector<T, 6> const families{{{2}, {1}, {1}, {-1}, {2}, {T(0.5)}}};
        return HolzapfelGasserOgden<T>{2, 1, T(0.5), T(0.1), 5}.at(families);
      },
      "HolzapfelGasserOgden", fibrous);
}

/// Calls visit(law, dimension) for each law in 2D and 3D, each in a section of its own.
template <Ask ask, class Visit>
void on_each_law(Visit const& visit) {
  on_each_maker([&](auto make, char const* name, Kind kind) {
    DYNAMIC_SECTION(name << " in 2D") {
      visit(any_law<ask, 2, double>(make(1.0), kind), std::integral_constant<int, 2>{});
    }
    DYNAMIC_SECTION(name << " in 3D") {
      visit(any_law<ask, 3, double>(make(1.0), kind), std::integral_constant<int, 3>{});
    }
  });
}

}  // namespace pliant::test

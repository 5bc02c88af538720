#pragma once

#include "work_precision/statics.hpp"

// Uniform meshes against adaptive ones, of the plane and of solids.
namespace pliant::bench {

/// Uniform meshes of an element, each twice as fine as the last, up to the largest that is allowed.
template <class Problem, class F, class T = double>
void add_uniform(std::vector<Contestant>& contestants, Options const& options,
                 std::string const& name) {
  using E = typename F::element;
  auto const limits = Limits::of<Problem>(options);
  for (int n : {2, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256}) {
    if (n < Problem::coarse) continue;
    auto const unknowns = E::dim * static_cast<long>(Problem::template mesh<E>(n).nodes.size());
    if (unknowns > 2 * limits.unknowns) break;
    Statics<Problem, T, F> const statics(options);
    contestants.push_back({"uniform", [=](bool with_errors) {
                             return std::vector{statics.uniform(n, name, with_errors)};
                           }});
  }
}

/// An adaptive run from the coarse mesh, of the first of some formulations; `rule` makes its Adaptation.
template <class Problem, class... Fs, class MakeAdaptation>
void add_adaptive(std::vector<Contestant>& contestants, Options const& options,
                  std::string const& name, MakeAdaptation const& rule) {
  Statics<Problem, double, Fs...> const statics(options);
  contestants.push_back({"adaptive", [=, rounds = std::make_shared<int>(0)](bool with_errors) {
                           auto answers = statics.adaptive(rule, name, Limits::of<Problem>(options),
                                                           *rounds, with_errors);
                           if (with_errors) *rounds = static_cast<int>(answers.size());
                           return answers;
                         }});
}

/// The rules for meshes that are compared.
template <class Problem, Element E>
void add_rules(std::vector<Contestant>& contestants, Options const& options,
               std::vector<double> const& shares) {
  using F = Formulation<E, Full<E>, Problem::template law>;
  std::string const element = E::name();
  for (double share : shares) {
    char text[64];
    std::snprintf(text, sizeof text, "%s, RecoveredStress bulk(%g)", E::name(), share);
    add_adaptive<Problem, F>(contestants, options, text, [share] {
      return Adaptation{when<F>(RecoveredStress{}).bulk(share).refine()};
    });
  }
  if constexpr (E::dim == 2 && E::degree == 1)
    add_adaptive<Problem, F>(contestants, options, element + ", R_S above 0.9 of largest", [] {
      return Adaptation{when<F>(ForceIntensity<>{}).above_fraction_of_largest(0.9).refine()};
    });
}

/// Linear elements that are raised, and refined then.
template <class Problem, Element E, Element Quadratic>
void add_degrees(std::vector<Contestant>& contestants, Options const& options) {
  using Low = Formulation<E, Full<E>, Problem::template law>;
  using High = Formulation<Quadratic, Full<Quadratic>, Problem::template law>;
  for (double share : {0.5, 0.65}) {
    char text[80];
    std::snprintf(text, sizeof text, "%s to %s, RecoveredStress bulk(%g)", E::name(),
                  Quadratic::name(), share);
    add_adaptive<Problem, Low, High>(contestants, options, text, [share] {
      return Adaptation{when<Low>(RecoveredStress{}).bulk(share).raise({.ring = 1}),
                        when<High>(RecoveredStress{}).bulk(share).refine()};
    });
  }
}

/// The degree and the size of each element by what they are worth: no round makes more than leaves a quarter of what is estimated.
template <class Problem, Element E, Element Quadratic>
void add_within(std::vector<Contestant>& contestants, Options const& options) {
  using Low = Formulation<E, Full<E>, Problem::template law>;
  using High = Formulation<Quadratic, Full<Quadratic>, Problem::template law>;
  char text[80];
  std::snprintf(text, sizeof text, "%s and %s, within", E::name(), Quadratic::name());
  add_adaptive<Problem, Low, High>(contestants, options, text, [] {
    return Adaptation{within<Low, High>(RecoveredStress{}, {.error = 1e-12})};
  });
}

/// Uniform meshes of some elements, under their full rules.
template <class Problem, Element... Es>
void add_elements(std::vector<Contestant>& contestants, Options const& options) {
  (add_uniform<Problem, Formulation<Es, Full<Es>, Problem::template law>>(
       contestants, options, std::string(Es::name()) + ", uniform"),
   ...);
}

template <class Problem>
void compare_meshes(Options const& options, std::vector<Contestant> contestants = {}) {
  add_elements<Problem, Tri3, Quad4, Tri6, Quad8, Quad9>(contestants, options);
  std::vector const shares{0.3, 0.5, 0.65, 0.8};
  add_rules<Problem, Tri3>(contestants, options, shares);
  add_rules<Problem, Quad4>(contestants, options, shares);
  add_rules<Problem, Tri6>(contestants, options, shares);
  add_rules<Problem, Quad9>(contestants, options, shares);
  add_degrees<Problem, Tri3, Tri6>(contestants, options);
  add_degrees<Problem, Quad4, Quad9>(contestants, options);
  add_within<Problem, Quad4, Quad9>(contestants, options);
  hold_contest(Problem::name, contestants, options);
}

/// The same of solids; one point in Hex8, and single precision beside. nvcc takes long: fewer where it compiles.
template <class Problem>
void compare_solids(Options const& options) {
  using Hex = Formulation<Hex8, Full<Hex8>, Problem::template law>;
  std::vector<Contestant> contestants;
  std::vector const shares{0.5, 0.65, 0.8};
#if defined(__CUDACC__)
  add_elements<Problem, Hex8, Hex27>(contestants, options);
#else
  add_elements<Problem, Tet4, Hex8, Tet10, Hex20, Hex27>(contestants, options);
  add_uniform<Problem, Formulation<Hex8, OnePoint, Problem::template law>>(
      contestants, options, "Hex8, uniform, OnePoint");
#endif
  add_uniform<Problem, Hex, float>(contestants, options, "Hex8, uniform, float");
  add_rules<Problem, Hex8>(contestants, options, shares);
  add_rules<Problem, Hex27>(contestants, options, shares);
#if !defined(__CUDACC__)
  add_rules<Problem, Tet4>(contestants, options, shares);
  add_rules<Problem, Tet10>(contestants, options, shares);
  add_degrees<Problem, Hex8, Hex27>(contestants, options);
  add_within<Problem, Hex8, Hex27>(contestants, options);
#endif
  hold_contest(Problem::name, contestants, options);
}

}  // namespace pliant::bench

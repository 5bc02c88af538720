#pragma once

#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>

#include "verification/support/compositions.hpp"
#include "work_precision/backend.hpp"

// Problems of statics: uniform meshes against adaptive ones.
//
// A Problem has
//   name                      what it is called
//   law<S>                    a template: its law
//   material()                the material
//   mesh<E>(n)                a mesh, n cells across
//   hold(body)                the conditions, once for a body
//   load(body)                what a user says again for each mesh: loads
//   group<F>(mesh)            where laws have values per element: the group with them
//   error<Es...>(body, report)   the relative error in the energy norm, over elements of some types
//   coarse                    n of the mesh that adaptive runs start from, and of the first uniform one
//   enough                    the error at which they end
//   most_unknowns             where fewer than Limits says are enough: at which they end; uniform meshes have up to twice as many
//   is_driven                 where the error is told by the energy of solids: whether nodes are driven, else loads pull
namespace pliant::bench {

using verification::Full;

/// Adaptive runs and meshes take at most so many unknowns, rounds and seconds.
struct Limits {
  long unknowns;
  int rounds;
  double seconds;

  template <class Problem>
  static Limits of(Options const& options) {
    auto limits = options.quick ? Limits{8000, 25, 1} : Limits{60000, 50, 2};
    if constexpr (requires { Problem::most_unknowns; })
      limits.unknowns = std::min(limits.unknowns, Problem::most_unknowns);
    return limits;
  }
};

/// Elements of the first formulation's type, which may turn into those of others.
template <class Problem, class T, class F, class... Others>
class Statics {
 public:
  explicit Statics(Options const& options) : threads_(options.threads) {}

  /// One mesh.
  Answer uniform(int n, std::string const& name, bool with_error) const {
    Answer answer{.name = name, .n = n};
    try {
      double total = 0;
      auto body = made(n, answer);
      auto const report = solved(body, answer);
      finish(body, report, answer, with_error);
      total = answer.making + answer.solving;
      answer.seconds = total;
    } catch (std::exception const& e) {
      answer.failed = e.what();
    }
    return answer;
  }

  /// Rounds of solving and refining, an answer for each.
  template <class MakeAdaptation>
  std::vector<Answer> adaptive(MakeAdaptation const& make_adaptation, std::string const& name,
                               Limits const& limits, int rounds_wanted, bool with_errors) const {
    std::vector<Answer> answers;
    Answer answer{.name = name};
    try {
      auto body = made(Problem::coarse, answer);
      auto adapt = make_adaptation();
      measure_adaptation(body);
      double decided = 0;  // s, so far
      for (int round = 0;; ++round) {
        answer.n = round;
        auto const report = solved(body, answer);
        answer.seconds = answer.making + answer.solving + answer.deciding + answer.refining;
        finish(body, report, answer, with_errors);
        answers.push_back(answer);
        if (with_errors ? is_last(answer, limits, round) : round + 1 == rounds_wanted) break;
        double all = 0;
        {
          Stopwatch const watch(all);
          adapt.now(body);
        }
        // By the clock on the wall, which may have gone further.
        double const criteria = body.parts().timers.criteria.seconds();
        double const deciding = std::min(criteria - decided, all);
        decided = criteria;
        answer.deciding += deciding;
        answer.refining += all - deciding;
      }
    } catch (std::exception const& e) {
      answer.failed = e.what();
      answers.push_back(answer);
    }
    return answers;
  }

 private:
  static bool is_last(Answer const& answer, Limits const& limits, int round) {
    return answer.error <= Problem::enough || answer.unknowns > limits.unknowns ||
           round + 1 >= limits.rounds || answer.seconds > limits.seconds;
  }
  auto made(int n, Answer& answer) const {
    Stopwatch const watch(answer.making);
    using E = typename F::element;
    auto const mesh = Problem::template mesh<E>(n);
    Body body{backend<T>(threads_), mesh::with_types<E, typename Others::element...>(mesh),
              Problem::material(), group_in<Problem, F>(mesh), group_in<Problem, Others>(mesh)...};
    Problem::hold(body);
    return body;
  }
  template <class TheBody>
  NewtonReport solved(TheBody& body, Answer& answer) const {
    Stopwatch const watch(answer.solving);
    Problem::load(body);
    return solve_static(body);
  }
  template <class TheBody>
  void finish(TheBody const& body, NewtonReport const& report, Answer& answer,
              bool with_error) const {
    answer.unknowns = report.unknowns;
    answer.iterations = report.iterations;
    answer.elements = 0;
    std::apply(
        [&](auto const&... list) { ((answer.elements += static_cast<long>(list.size())), ...); },
        body.mesh().tables);
    if (with_error)
      answer.error = Problem::template error<typename F::element, typename Others::element...>(
          body, as_of_full_rule(body, report));
  }
  /// Where the error is told by the energy: under OnePoint, which sees less of it, that of a body with the same displacements, or under
  /// loads what makes up for them to the same potential energy.
  template <class TheBody>
  static NewtonReport as_of_full_rule(TheBody const& body, NewtonReport report) {
    if constexpr (std::same_as<typename F::quadrature, OnePoint> &&
                  requires { Problem::is_driven; }) {
      using E = typename F::element;
      using G = Formulation<E, Full<E>, F::template law>;
      Body full{backend<double>(1), body.mesh(), Problem::material(), Group<G>{}};
      full.set_displacements(body.displacements());
      double const energy = strain_energy(full);
      report.energy = Problem::is_driven ? energy : 2 * report.energy - energy;
    }
    return report;
  }

  int threads_;
};

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
#endif
  hold_contest(Problem::name, contestants, options);
}

/// J: the strain energy that Problem::graded(n), which is finer towards the singular places, has at rest.
template <class Problem>
double energy_of_graded(int n) {
  return [n]<Element E>(Mesh<E> const& mesh) {
    Body body{backend<double>(1), mesh, Problem::material(),
              Group<Formulation<E, Full<E>, Problem::template law>>{}};
    Problem::hold(body);
    Problem::load(body);
    return solve_static(body).energy;
  }(Problem::graded(n));
}
/// Sets Problem::reference. What it still lacks goes to stderr, as the error of half as many cells.
template <class Problem>
void find_reference() {
  Problem::reference = energy_of_graded<Problem>(64);
  std::fprintf(stderr, "%s: reference energy %.12g J, relative error of half as many cells %.1e\n",
               Problem::name, Problem::reference,
               1 - energy_of_graded<Problem>(32) / Problem::reference);
}
/// Prints what Problem::reference was extrapolated from.
template <class Problem>
void print_energies(std::vector<int> const& sizes) {
  for (int n : sizes)
    std::printf("%s, graded, n = %d: %.10g J\n", Problem::name, n, energy_of_graded<Problem>(n));
}
/// Of the least potential energy what the strain energy is off by that of the solution is the error's: it lacks it under loads,
/// where the law is linear, and has it too much where nodes are driven.
inline double error_of(double energy, double reference) {
  return std::sqrt(std::abs(reference - energy) / reference);
}

}  // namespace pliant::bench

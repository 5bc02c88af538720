#pragma once

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>

#include "verification/support/compositions.hpp"
#include "work_precision/contest.hpp"

// Problems of statics: uniform meshes against adaptive ones.
//
// A Problem has
//   name                      what it is called
//   law<S>                    a template: its law
//   material()                the material
//   mesh<E>(n)                a mesh, n cells across
//   hold(body)                the conditions, once for a body
//   load(body)                what a user says again for each mesh: loads
//   error<Es...>(body, report)   the relative error in the energy norm, over elements of some types
//   coarse                    n of the mesh that adaptive runs start from
//   enough                    the error at which they end
namespace pliant::bench {

using verification::Full;

/// Adaptive runs and meshes take at most so many unknowns, rounds and seconds.
struct Limits {
  long unknowns;
  int rounds;
  double seconds;

  static Limits of(Options const& options) {
    return options.quick ? Limits{8000, 25, 1} : Limits{60000, 50, 2};
  }
};

/// Elements of the first formulation's type, which may turn into those of others.
template <class Problem, class F, class... Others>
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
        double const deciding = body.parts().timers.criteria.seconds();
        answer.refining += all - (deciding - answer.deciding);
        answer.deciding = deciding;
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
    Body body{OpenMP<double>{{.threads = threads_}},
              mesh::with_types<E, typename Others::element...>(Problem::template mesh<E>(n)),
              Problem::material(), Group<F>{}, Group<Others>{}...};
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
      answer.error =
          Problem::template error<typename F::element, typename Others::element...>(body, report);
  }

  int threads_;
};

/// Uniform meshes of an element, each twice as fine as the last, up to the largest that is allowed.
template <class Problem, class F>
void add_uniform(std::vector<Contestant>& contestants, Options const& options,
                 std::string const& name) {
  auto const limits = Limits::of(options);
  for (int n : {4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256}) {
    auto const unknowns =
        2 * static_cast<long>(Problem::template mesh<typename F::element>(n).nodes.size());
    if (unknowns > 2 * limits.unknowns) break;
    Statics<Problem, F> const statics(options);
    contestants.push_back({"uniform", [=](bool with_errors) {
                             return std::vector{statics.uniform(n, name, with_errors)};
                           }});
  }
}

/// An adaptive run from the coarse mesh, of the first of some formulations; `rule` makes its Adaptation.
template <class Problem, class... Fs, class MakeAdaptation>
void add_adaptive(std::vector<Contestant>& contestants, Options const& options,
                  std::string const& name, MakeAdaptation const& rule) {
  Statics<Problem, Fs...> const statics(options);
  contestants.push_back({"adaptive", [=, rounds = std::make_shared<int>(0)](bool with_errors) {
                           auto answers = statics.adaptive(rule, name, Limits::of(options), *rounds,
                                                           with_errors);
                           if (with_errors) *rounds = static_cast<int>(answers.size());
                           return answers;
                         }});
}

/// The rules for meshes that are compared.
template <class Problem, Element E>
void add_rules(std::vector<Contestant>& contestants, Options const& options) {
  using F = Formulation<E, Full<E>, Problem::template law>;
  std::string const element = E::name();
  for (double share : {0.3, 0.5, 0.65, 0.8}) {
    char text[64];
    std::snprintf(text, sizeof text, "%s, RecoveredStress bulk(%g)", E::name(), share);
    add_adaptive<Problem, F>(contestants, options, text, [share] {
      return Adaptation{when<F>(RecoveredStress{}).bulk(share).refine()};
    });
  }
  if constexpr (E::degree == 1)
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

template <class Problem>
void compare_meshes(Options const& options, std::vector<Contestant> contestants = {}) {
  auto const uniform = [&]<Element E>(E) {
    using F = Formulation<E, Full<E>, Problem::template law>;
    add_uniform<Problem, F>(contestants, options, std::string(E::name()) + ", uniform");
  };
  uniform(Tri3{});
  uniform(Quad4{});
  uniform(Tri6{});
  uniform(Quad8{});
  uniform(Quad9{});
  add_rules<Problem, Tri3>(contestants, options);
  add_rules<Problem, Quad4>(contestants, options);
  add_rules<Problem, Tri6>(contestants, options);
  add_rules<Problem, Quad9>(contestants, options);
  add_degrees<Problem, Tri3, Tri6>(contestants, options);
  add_degrees<Problem, Quad4, Quad9>(contestants, options);
  hold_contest(Problem::name, contestants, options);
}

/// Sets Problem::reference, J: the strain energy that Problem::graded(n), which is finer towards the singular
/// corners, has at rest under its loads. What it still lacks goes to stderr, as the error of half as many cells.
template <class Problem>
void find_reference() {
  using F = Formulation<Quad9, Gauss<3>, Problem::template law>;
  auto const energy = [](int n) {
    Body body{OpenMP<double>{{.threads = 1}}, Problem::graded(n), Problem::material(), Group<F>{}};
    Problem::hold(body);
    Problem::load(body);
    return solve_static(body).energy;
  };
  Problem::reference = energy(64);
  std::fprintf(stderr, "%s: reference energy %.12g J, relative error of half as many cells %.1e\n",
               Problem::name, Problem::reference, 1 - energy(32) / Problem::reference);
}
/// Of linear laws at rest under loads: what the strain energy lacks of that of the solution is the error's.
inline double error_of(double energy, double reference) {
  return std::sqrt((reference - energy) / reference);
}

}  // namespace pliant::bench

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

}  // namespace pliant::bench

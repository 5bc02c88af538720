#include <pliant/solver/local_steps.hpp>

#include "work_precision/slit_plate.hpp"

// The slit plate brought to rest by explicit steps: the outer sides move to where they belong, and damping takes what
// swings. It is at rest to the digits of the error that solve_static leaves on the same mesh.
namespace pliant::bench {

struct RelaxedSlitPlate {
  static constexpr double damping = 700;              // 1/s, twice the lowest frequency or so
  static constexpr double ramp = 0.002, rest = 0.05;  // s
  static constexpr double between = 0.0015;           // s, from refinement to refinement

  template <class F>
  static auto body(int n, int threads) {
    Body made{OpenMP<double>{{.threads = threads}}, SlitPlate::mesh<typename F::element>(n),
              SlitPlate::material(), Group<F>{}};
    made.drive(SlitPlate::outside(made.mesh()), [](Point<2> const& X, double t) {
      double const s = std::min(1.0, t / ramp), share = s * s * (3 - 2 * s);
      auto const u = SlitPlate::field(X[0], X[1], X[0], X[1]);
      return Point<2>{share * u[0], share * u[1]};
    });
    made.set_damping(damping);
    return made;
  }

  template <class TheBody, class Step>
  static void run_until(TheBody& body, Step& step, double end) {
    while (body.time() < end) step(body, 16);
  }

  template <class F, class TheBody>
  static void finish(TheBody const& body, Answer& answer, bool with_error) {
    using E = typename F::element;
    answer.seconds = answer.making + answer.solving + answer.refining;
    answer.unknowns = 2 * body.nodes();
    answer.elements = static_cast<long>(body.mesh().template elements<E>().size());
    answer.iterations = static_cast<long>(body.steps());
    if (with_error) answer.error = SlitPlate::error<E>(body, NewtonReport{});
  }

  template <class F>
  static Contestant uniform(int n, Options const& options) {
    return {"uniform", [n, threads = options.threads](bool with_error) {
              Answer answer{.name = std::string(F::element::name()) + ", uniform", .n = n};
              try {
                auto body = [&] {
                  Stopwatch const watch(answer.making);
                  return RelaxedSlitPlate::body<F>(n, threads);
                }();
                {
                  Stopwatch const watch(answer.solving);
                  CentralDifference step;
                  run_until(body, step, rest);
                }
                finish<F>(body, answer, with_error);
              } catch (std::exception const& e) {
                answer.failed = e.what();
              }
              return std::vector{answer};
            }};
  }

  /// From 8 cells across; refined so often on the way to rest.
  template <class F, class Step>
  static Contestant adaptive(int rounds, char const* name, Options const& options) {
    return {"adaptive", [=, threads = options.threads](bool with_error) {
              Answer answer{
                  .name = std::string(F::element::name()) + ", RecoveredStress bulk(0.65)" + name,
                  .n = rounds};
              try {
                auto body = [&] {
                  Stopwatch const watch(answer.making);
                  return RelaxedSlitPlate::body<F>(8, threads);
                }();
                Step step;
                Adaptation adapt{when<F>(RecoveredStress{}).bulk(0.65).refine()};
                double end = rest / 3;
                for (int round = 0; round <= rounds; ++round) {
                  {
                    Stopwatch const watch(answer.solving);
                    run_until(body, step, end);
                  }
                  if (round == rounds) break;
                  Stopwatch const watch(answer.refining);
                  adapt.now(body);
                  end += round + 1 < rounds ? between : rest / 3;
                }
                finish<F>(body, answer, with_error);
              } catch (std::exception const& e) {
                answer.failed = e.what();
              }
              return std::vector{answer};
            }};
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant::bench;
  using Quads = pliant::Formulation<pliant::Quad4, pliant::Gauss<2>, pliant::Hooke>;
  using Triangles = pliant::Formulation<pliant::Tri3, pliant::Gauss<1>, pliant::Hooke>;
  Options options{argc, argv};
  SlitPlate::find_reference();
  std::vector<Contestant> contestants;
  auto const add = [&]<class F>(F) {
    for (int n : {16, 32, 64, 128, 192, 256})
      if (!options.quick || n < 100)
        contestants.push_back(RelaxedSlitPlate::uniform<F>(n, options));
    for (int rounds = 3; rounds <= (options.quick ? 5 : 8); ++rounds) {
      contestants.push_back(
          RelaxedSlitPlate::adaptive<F, pliant::CentralDifference>(rounds, "", options));
      contestants.push_back(
          RelaxedSlitPlate::adaptive<F, pliant::LocalSteps>(rounds, ", LocalSteps", options));
    }
  };
  add(Quads{});
  add(Triangles{});
  options.rounds = std::min(options.rounds, 3);  // minutes each
  hold_contest("slit plate, explicit", contestants, options);
}

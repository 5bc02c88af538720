#include "work_precision/reference_energy.hpp"

// A load that wanders along a block, place by place at rest: a mesh that holds an error or a budget follows it. Errors are
// root mean squares over the places, in the energy norm; times are of all places together.
namespace pliant::bench {

using Block = Formulation<Quad4, Gauss<2>, Hooke>;

namespace wandering {

inline constexpr Elastic material{.young = 1e5, .poisson = 0.3, .density = 1e3};
inline std::vector<double> places(bool quick) {
  std::vector<double> all;
  for (double x = 1; x < (quick ? 1.4 : 2); x += 0.04) all.push_back(x);
  return all;
}

template <class F>
auto block(int n, int threads) {
  using E = typename F::element;
  Body body{OpenMP<double>{{.threads = threads}},
            mesh::rectangle<E>({.size = {4, 1}, .cells = {4 * n, n}}), material, Group<F>{}};
  body.clamp(body.mesh().boundary("bottom"));
  return body;
}
template <class TheBody>
void load(TheBody& body, double place) {
  body.set_loads(
      traction_loads(body.mesh(), body.mesh().boundary("top"), [place](Point<2> const& X) {
        return Point<2>{0, -1e3 * std::exp(-square((X[0] - place) / 0.05))};
      }));
}
template <class TheBody>
NewtonReport solve(TheBody& body, double place, Answer& answer) {
  Stopwatch const watch(answer.solving);
  load(body, place);
  return solve_static(body);
}

class Walk {
 public:
  explicit Walk(Options const& options)
      : places_(places(options.quick)), threads_(options.threads), references_(places_.size()) {
    using Fine = Formulation<Quad9, Gauss<3>, Hooke>;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      auto body = block<Fine>(options.quick ? 32 : 64, threads_);
      Answer unused;
      references_[k] = solve(body, places_[k], unused).energy;
    }
  }
  double energy() const { return references_[references_.size() / 2]; }

  /// find(body, place, answer) comes to rest at a place.
  template <class Find>
  Answer answer(std::string const& name, int n, bool afresh, Find const& find) const {
    Answer answer{.name = name, .n = n};
    try {
      double squares = 0, unknowns = 0, elements = 0;
      auto body = block<Block>(n, threads_);
      for (std::size_t k = 0; k < places_.size(); ++k) {
        auto fresh = block<Block>(n, threads_);
        auto& own = afresh ? fresh : body;
        NewtonReport const report = find(own, places_[k], answer);
        squares += square(error_of(report.energy, references_[k]));
        unknowns += static_cast<double>(report.unknowns);
        elements += static_cast<double>(own.mesh().template elements<Quad4>().size());
      }
      auto const count = static_cast<double>(places_.size());
      answer.error = std::sqrt(squares / count);
      answer.unknowns = std::lround(unknowns / count);
      answer.elements = std::lround(elements / count);
      answer.seconds = answer.solving + answer.refining;
    } catch (std::exception const& e) {
      answer.failed = e.what();
    }
    return answer;
  }

 private:
  std::vector<double> places_;
  int threads_;
  std::vector<double> references_;
};

/// Looks until the estimate is at most `error`, or so many times.
template <class TheBody, class TheAdaptation>
NewtonReport follow(TheBody& body, double place, double error, int looks, TheAdaptation& adapt,
                    Answer& answer) {
  auto report = solve(body, place, answer);
  for (int k = 0; k < looks; ++k) {
    {
      Stopwatch const watch(answer.refining);
      if (k > 0 && estimate(body, RecoveredStress{}) <= error) break;
      adapt.now(body);
    }
    report = solve(body, place, answer);
  }
  return report;
}

}  // namespace wandering
}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::bench;
  Options const options(argc, argv);
  auto const walk = std::make_shared<wandering::Walk>(options);
  std::vector<Contestant> contestants;
  auto const add = [&](char const* kind, std::string const& name, int n, bool afresh,
                       auto const& find) {
    contestants.push_back(
        {kind, [=](bool) { return std::vector{walk->answer(name, n, afresh, find)}; }});
  };
  for (int n : {8, 16, 24, 32, 48, 64}) {
    if (options.quick && n > 32) break;
    add("uniform", "Quad4, uniform", n, false,
        [](auto& body, double place, Answer& a) { return wandering::solve(body, place, a); });
  }
  for (double relative : {0.15, 0.1, 0.07, 0.05}) {
    double const error = square(relative) * walk->energy();
    char text[64];
    std::snprintf(text, sizeof text, "Quad4, within an error of %g", relative);
    add("adaptive", text, 4, false, [error](auto& body, double place, Answer& a) {
      auto adapt = Adaptation{within<Block>(RecoveredStress{}, {.error = error})};
      return wandering::follow(body, place, error, 8, adapt, a);
    });
    std::snprintf(text, sizeof text, "Quad4, bulk(0.65) afresh to %g", relative);
    add("adaptive", text, 4, true, [error](auto& body, double place, Answer& a) {
      auto adapt = Adaptation{when<Block>(RecoveredStress{}).bulk(0.65).refine()};
      return wandering::follow(body, place, error, 30, adapt, a);
    });
  }
  for (double budget : {500.0, 1000.0, 2000.0}) {
    char text[64];
    std::snprintf(text, sizeof text, "Quad4, within %g evaluations", budget);
    add("adaptive", text, 4, false, [budget](auto& body, double place, Answer& a) {
      auto adapt = Adaptation{within<Block>(RecoveredStress{}, {.evaluations_per_step = budget})};
      return wandering::follow(body, place, 0, 4, adapt, a);
    });
  }
  hold_contest("load that wanders", contestants, options);
}

#pragma once

#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>
#include <pliant/solver/local_steps.hpp>

#include "work_precision/backend.hpp"

// Bodies that move, seen at equal times: runs of one problem beside a trusted history.
namespace pliant::bench {

/// √(Σ |u − v|² / Σ |v|²) over whatever is compared.
struct Apart {
  double off = 0, all = 0;

  template <std::size_t Dim>
  void add(std::array<double, Dim> const& u, std::array<double, Dim> const& v) {
    for (std::size_t k = 0; k < Dim; ++k) {
      off += square(u[k] - v[k]);
      all += square(v[k]);
    }
  }
  double relative() const { return std::sqrt(off / all); }
};

/// The node at a place.
template <class M>
std::size_t node_at(M const& mesh, Point<M::dim> const& place) {
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    double apart = 0;
    for (std::size_t k = 0; k < M::dim; ++k) apart += square(mesh.nodes[i][k] - place[k]);
    if (apart < 1e-12) return i;
  }
  throw Error("bench: no node at the place that is compared");
}

/// Samples of a motion, so many seconds apart.
struct Samples {
  int count;
  double apart;  // s

  /// Steps that end with each sample, at most so long.
  int steps_within(double longest) const { return static_cast<int>(std::ceil(apart / longest)); }

  /// Steps of CentralDifference, `safety` times what is stable at rest.
  auto explicit_steps(double safety) const {
    return [samples = *this, safety](auto& body) {
      int const steps = samples.steps_within(safety * stable_step(body));
      return [steps, step = CentralDifference{{.step = samples.apart / steps}}](auto& b) mutable {
        step(b, steps);
      };
    };
  }
  /// The same, with looks of the Adaptation that `rules` makes.
  template <class MakeRules>
  auto explicit_steps(double safety, MakeRules const& rules) const {
    return [samples = *this, safety, rules](auto& body) {
      int const steps = samples.steps_within(safety * stable_step(body));
      return [steps, step = CentralDifference{{.step = samples.apart / steps}},
              adapt = rules()](auto& b) mutable { step(b, steps, adapt); };
    };
  }
};

/// Advances a body by what begin(body) makes, calls see(body, sample) at each sample, and adds the time between them to `seconds`.
/// Throws Error where the integrator went back and did not come to the last.
template <class TheBody, class Begin, class See>
void advance_through(Samples const& samples, TheBody& body, Begin const& begin, See const& see,
                     double& seconds) {
  auto advance = begin(body);
  for (int sample = 0; sample < samples.count; ++sample) {
    {
      Stopwatch const watch(seconds);
      advance(body);
      body.parts().backend.synchronize();
    }
    see(std::as_const(body), sample);
  }
  if (std::abs(body.time() - samples.count * samples.apart) > 1e-9 * samples.apart)
    throw Error("the integrator went back, and did not reach the last sample");
}
/// What probe(body) says at each sample of such a run: a trusted history.
template <class TheBody, class Begin, class Probe>
auto history(Samples const& samples, TheBody& body, Begin const& begin, Probe const& probe) {
  std::vector<decltype(probe(body))> found;
  double unused = 0;
  advance_through(
      samples, body, begin, [&](auto const& now, int) { found.push_back(probe(now)); }, unused);
  return found;
}

/// Of a body's elements of a type, the share of evaluations that were those of its last group; none where there is one.
template <Element E, class TheBody>
double share_of_last_group(TheBody const& body) {
  auto const steps = element_steps<E>(body);
  if (steps.size() == 1) return Answer{}.share;
  double sum = 0;
  for (auto n : steps) sum += static_cast<double>(n);
  return static_cast<double>(steps.back()) / sum;
}

/// A run: make() makes the body, begin(body) what advances it from sample to sample, and see(body, sample, apart)
/// compares it with the truth, while the clock stands.
template <class Make, class Begin, class See>
Contestant moving(char const* kind, std::string const& name, int n, Samples const& samples,
                  Make const& make, Begin const& begin, See const& see) {
  return {kind, [=](bool) {
            Answer answer{.name = name, .n = n};
            try {
              auto body = [&] {
                Stopwatch const watch(answer.making);
                return make();
              }();
              Apart apart;
              advance_through(
                  samples, body, begin,
                  [&](auto const& now, int sample) { see(now, sample, apart); }, answer.solving);
              answer.seconds = answer.making + answer.solving;
              answer.error = apart.relative();
              answer.unknowns = static_cast<long>(body.mesh().dim * body.mesh().nodes.size());
              [&]<Element... Es>(Mesh<Es...> const& mesh) {
                answer.elements = (static_cast<long>(mesh.template elements<Es>().size()) + ...);
                if constexpr (sizeof...(Es) == 1) answer.share = share_of_last_group<Es...>(body);
              }(body.mesh());
            } catch (std::exception const& e) {
              answer.failed = e.what();
            }
            return std::vector{answer};
          }};
}

}  // namespace pliant::bench

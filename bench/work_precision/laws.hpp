#pragma once

#include <memory>

#include "verification/support/compositions.hpp"
#include "work_precision/motion.hpp"

// Solids that move under a costly law, where few elements need it. Errors are those of the history of one node beside the costly law
// in half the steps on the same mesh.
//
// A Scene has
//   material             the material
//   mesh<E>()            its mesh, of elements of about one size
//   volume               m³, of the whole
//   begin(body)          its conditions and its first velocities
//   place                of the node that is compared
//   samples              of its history, sixteen steps apart
//   group<F>(mesh)       where laws have parameters of their own or values per element: the group with them
namespace pliant::bench {

using verification::Full;

/// Runs of a scene, under a costly law and under others.
template <class Scene, Element E, template <class> class Costly>
class LawContest {
 public:
  using F = Formulation<E, Full<E>, Costly>;

  LawContest(Options const& options, std::string costly)
      : costly_(std::move(costly)), threads_(options.threads) {
    auto body = make<double, F>(threads_);
    elements_ = body.mesh().template elements<E>().size();
    // Stiffening shortens the stable step.
    samples_ = {options.quick ? Scene::samples / 5 : Scene::samples,
                steps_of_a_sample * 0.6 * stable_step(body)};
    *truth_ = history(samples_, body, steps(2), [](auto const& now) { return displacement(now); });
  }

  /// All elements under one law.
  template <class T, template <class> class L>
  void add_plain(std::string const& name) {
    add<T, Formulation<E, Full<E>, L>>("one law", name, steps(1));
  }

  /// Elements under a cheap law until their strain (or what `criterion` says) exceeds `above`; they go back where
  /// the cheap law is off by less than half of what it is off there.
  template <template <class> class Cheap, class Criterion>
  void add_adaptive(std::string const& cheap, Criterion const& criterion, double above) {
    using G = Formulation<E, Full<E>, Cheap>;
    char text[96];
    std::snprintf(text, sizeof text, "%s, %s above %g", cheap.c_str(), costly_.c_str(), above);
    add<double, G, F>("switching", text, steps(1, [=, joules = joules_at(above)] {
                        return Adaptation{
                            when<G>(criterion).above(above).template become<F>(),
                            when<F>(LawDiscrepancy<G>{}).below(joules / 4).template become<G>()};
                      }));
  }

  /// Each element under the cheapest of the laws whose discrepancy from the costly one is that of a stress off by
  /// E ε²/2 at strains of `above`, looked at every 64 steps.
  template <template <class> class... Cheap>
  void add_cheapest(std::string const& cheap, double above) {
    char text[96];
    std::snprintf(text, sizeof text, "cheapest of %s, %s at %g", cheap.c_str(), costly_.c_str(),
                  above);
    add<double, Formulation<E, Full<E>, Cheap>..., F>(
        "switching", text, steps(1, [joules = joules_at(above)] {
          return Adaptation{cheapest<Formulation<E, Full<E>, Cheap>..., F>({.tolerance = joules})}
              .every(64);
        }));
  }

  void hold(std::string const& problem, Options const& options) const {
    hold_contest(problem, contestants_, options);
  }

 private:
  static constexpr int steps_of_a_sample = 16;

  template <class T, class... Fs>
  static auto make(int threads) {
    auto const mesh = Scene::template mesh<E>();
    Body body{backend<T>(threads), mesh, Scene::material, group_in<Scene, Fs>(mesh)...};
    Scene::begin(body);
    return body;
  }
  template <class TheBody>
  static Point<3> displacement(TheBody const& body) {
    return body.displacements()[node_at(body.mesh(), Scene::place)];
  }
  /// J: of an element whose stress is off by E ε²/2.
  double joules_at(double strain) const {
    return Scene::volume / static_cast<double>(elements_) * Scene::material.young / 2 *
           square(strain * strain / 2);
  }
  auto steps(int finer) const {
    return [apart = samples_.apart, n = steps_of_a_sample * finer](auto&) {
      return [n, step = CentralDifference{{.step = apart / n}}](auto& b) mutable { step(b, n); };
    };
  }
  template <class MakeRules>
  auto steps(int finer, MakeRules const& rules) const {
    return [apart = samples_.apart, n = steps_of_a_sample * finer, rules](auto&) {
      return [n, step = CentralDifference{{.step = apart / n}}, adapt = rules()](auto& b) mutable {
        step(b, n, adapt);
      };
    };
  }
  template <class T, class... Fs, class Begin>
  void add(char const* kind, std::string const& name, Begin const& begin) {
    contestants_.push_back(moving(
        kind, name, 0, samples_, [threads = threads_] { return make<T, Fs...>(threads); }, begin,
        [truth = truth_](auto const& body, int sample, Apart& apart) {
          apart.add(displacement(body), (*truth)[static_cast<std::size_t>(sample)]);
        }));
  }

  std::string costly_;
  int threads_;
  std::size_t elements_ = 0;
  Samples samples_{};
  std::shared_ptr<std::vector<Point<3>>> truth_ = std::make_shared<std::vector<Point<3>>>();
  std::vector<Contestant> contestants_;
};

/// Under Ogden's law, and under the cheaper ones beside it.
template <class Scene, Element E>
void compare_ogden(std::string const& problem, Options const& options) {
  LawContest<Scene, E, Ogden> contest(options, "Ogden");
  contest.template add_plain<double, SaintVenantKirchhoff>("Saint Venant-Kirchhoff");
  contest.template add_plain<double, NeoHookean>("neo-Hookean");
  contest.template add_plain<double, Ogden>("Ogden");
  contest.template add_plain<float, Ogden>("Ogden, float");
  for (double above : {0.005, 0.01, 0.02, 0.05})
    contest.template add_adaptive<SaintVenantKirchhoff>("Saint Venant-Kirchhoff", StrainNorm{},
                                                        above);
  for (double above : {0.01, 0.03, 0.1})
    contest.template add_adaptive<NeoHookean>("neo-Hookean", StrainNorm{}, above);
  for (double above : {0.01, 0.03, 0.1}) {
    contest.template add_cheapest<NeoHookean>("neo-Hookean", above);
    contest.template add_cheapest<SaintVenantKirchhoff, NeoHookean>(
        "Saint Venant-Kirchhoff, neo-Hookean", above);
  }
  contest.hold(problem, options);
}

}  // namespace pliant::bench

#pragma once

#include <memory>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>

#include "verification/support/compositions.hpp"
#include "work_precision/contest.hpp"

// A stiff block with a slender arm that swings under its weight: few elements need a costly law. Errors are those of
// the history of the arm's tip beside the costly law in half the steps on the same mesh.
namespace pliant::bench {

using verification::Full;

namespace arm {

inline constexpr int block = 8, length = 16, first = 3,
                     last = 5;         // cells; the arm's are [first, last)²
inline constexpr double edge = 0.125;  // m
inline constexpr Elastic material{.young = 3e6, .poisson = 0.3, .density = 1e3};
inline constexpr int samples_apart = 16;  // steps between samples of the tip

/// A cube of block³ cells, and an arm from the middle of its right side.
template <Element E>
Mesh<E> mesh() {
  int const cells = block + length;
  auto const grid = mesh::box<E>(
      {.size = {cells * edge, block * edge, block * edge}, .cells = {cells, block, block}});
  Mesh<E> mesh;
  std::vector<Index> number(grid.nodes.size(), -1);
  for (auto element : grid.template elements<E>()) {
    Point<3> middle{};
    for (Index node : element)
      for (std::size_t k = 0; k < 3; ++k)
        middle[k] += grid.nodes[static_cast<std::size_t>(node)][k] / E::nodes / edge;
    auto const in_arm = [](double x) { return x > first && x < last; };
    if (middle[0] > block && !(in_arm(middle[1]) && in_arm(middle[2]))) continue;
    for (Index& node : element) {
      auto const old = static_cast<std::size_t>(node);
      if (number[old] < 0) {
        number[old] = static_cast<Index>(mesh.nodes.size());
        mesh.nodes.push_back(grid.nodes[old]);
      }
      node = number[old];
    }
    mesh.template elements<E>().push_back(element);
  }
  mesh.boundaries["left"] =
      mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[0] < 1e-9; });
  return mesh;
}

/// The node in the middle of the arm's end.
template <class M>
std::size_t tip(M const& mesh) {
  Point<3> const place{(block + length) * edge, (first + last) * edge / 2,
                       (first + last) * edge / 2};
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    double apart = 0;
    for (std::size_t k = 0; k < 3; ++k) apart += square(mesh.nodes[i][k] - place[k]);
    if (apart < 1e-12) return i;
  }
  throw Error("arm: no node at the tip");
}

using History = std::vector<Point<3>>;

/// √(Σ |u − v|² / Σ |v|²).
inline double apart(History const& u, History const& v) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      off += square(u[i][k] - v[i][k]);
      all += square(v[i][k]);
    }
  return std::sqrt(off / all);
}

/// What all contestants share.
struct Plan {
  double step;  // s
  int samples;
  int threads;
};

template <class T, class... Fs>
auto body(Plan const& plan) {
  using E = typename std::tuple_element_t<0, std::tuple<Fs...>>::element;
  Body body{OpenMP<T>{{.threads = plan.threads}}, mesh<E>(), material, Group<Fs>{}...};
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -9.81, 0});
  return body;
}

/// Lets a body swing; take(step, body, n) takes steps.
template <class TheBody, class Take>
History swing(TheBody& body, Plan const& plan, int finer, Take const& take, double& seconds) {
  History history;
  std::size_t const end = tip(body.mesh());
  CentralDifference step{{.step = plan.step / finer}};
  for (int sample = 0; sample < plan.samples; ++sample) {
    {
      Stopwatch const watch(seconds);
      take(step, body, samples_apart * finer);
    }
    history.push_back(body.displacements()[end]);
  }
  return history;
}

/// Runs of one arm, under a costly law and under others.
template <Element E, template <class> class Costly>
class Arm {
 public:
  using F = Formulation<E, Full<E>, Costly>;

  Arm(Options const& options, std::string costly) : costly_(std::move(costly)) {
    plan_ = {1, options.quick ? 20 : 100, options.threads};
    auto at_rest = body<double, F>(plan_);
    // Stiffening shortens the stable step.
    plan_.step = 0.6 * stable_step(at_rest);
    double unused = 0;
    truth_ = std::make_shared<History>(swing(at_rest, plan_, 2, plain, unused));
    count_ = static_cast<long>(at_rest.mesh().template elements<E>().size());
    nodes_ = at_rest.nodes();
  }

  /// All elements under one law.
  template <class T, template <class> class L>
  void add_plain(std::string const& name) {
    using G = Formulation<E, Full<E>, L>;
    add("one law", name, [plan = plan_](Answer& answer) {
      auto all = body<T, G>(plan);
      return swing(all, plan, 1, plain, answer.seconds);
    });
  }

  /// Elements under a cheap law until their strain (or what `criterion` says) exceeds `above`; they go back where
  /// the cheap law is off by less than half of what it is off there.
  template <template <class> class Cheap, class Criterion>
  void add_adaptive(std::string const& cheap, Criterion const& criterion, double above) {
    using G = Formulation<E, Full<E>, Cheap>;
    char text[96];
    std::snprintf(text, sizeof text, "%s, %s above %g", cheap.c_str(), costly_.c_str(), above);
    // The energy of a stress that is off by E ε²/2.
    double const volume = edge * edge * edge / (E::nodes == 4 ? 6 : 1);
    double const joules = volume * material.young / 2 * square(above * above / 2);
    add("switching", text, [plan = plan_, criterion, above, joules](Answer& answer) {
      Adaptation adapt{when<G>(criterion).above(above).template become<F>(),
                       when<F>(LawDiscrepancy<G>{}).below(joules / 4).template become<G>()};
      auto both = body<double, G, F>(plan);
      auto const take = [&](auto& step, auto& body, int n) { step(body, n, adapt); };
      auto const history = swing(both, plan, 1, take, answer.seconds);
      auto const steps = element_steps<E>(both);
      answer.share = static_cast<double>(steps[1]) / static_cast<double>(steps[0] + steps[1]);
      return history;
    });
  }

  /// Each element under the cheapest of the laws whose discrepancy from the costly one is that of a stress off by
  /// E ε²/2 at strains of `above`, looked at every 64 steps.
  template <template <class> class... Cheap>
  void add_cheapest(std::string const& cheap, double above) {
    char text[96];
    std::snprintf(text, sizeof text, "cheapest of %s, %s at %g", cheap.c_str(), costly_.c_str(),
                  above);
    double const volume = edge * edge * edge / (E::nodes == 4 ? 6 : 1);
    double const joules = volume * material.young / 2 * square(above * above / 2);
    add("switching", text, [plan = plan_, joules](Answer& answer) {
      auto adapt =
          Adaptation{cheapest<Formulation<E, Full<E>, Cheap>..., F>({.tolerance = joules})}.every(
              64);
      auto all = body<double, Formulation<E, Full<E>, Cheap>..., F>(plan);
      auto const take = [&](auto& step, auto& body, int n) { step(body, n, adapt); };
      auto const history = swing(all, plan, 1, take, answer.seconds);
      auto const steps = element_steps<E>(all);
      double sum = 0;
      for (auto n : steps) sum += static_cast<double>(n);
      answer.share = static_cast<double>(steps.back()) / sum;
      return history;
    });
  }

  void hold_contest(std::string const& problem, Options const& options) const {
    bench::hold_contest(problem, contestants_, options);
  }

 private:
  static constexpr auto plain = [](auto& step, auto& body, int n) { step(body, n); };

  template <class Run>
  void add(char const* kind, std::string const& name, Run const& run) {
    contestants_.push_back(
        {kind, [=, truth = truth_, unknowns = 3 * nodes_, elements = count_](bool) {
           Answer answer{.name = name, .unknowns = unknowns, .elements = elements};
           try {
             answer.error = apart(run(answer), *truth);
           } catch (std::exception const& e) {
             answer.failed = e.what();
           }
           return std::vector{answer};
         }});
  }

  std::string costly_;
  Plan plan_{};
  std::shared_ptr<History> truth_;
  long count_ = 0, nodes_ = 0;
  std::vector<Contestant> contestants_;
};

}  // namespace arm

/// Under Ogden's law, and under the cheaper ones beside it.
template <Element E>
void swing_under_ogden(std::string const& problem, Options const& options) {
  arm::Arm<E, Ogden> arm(options, "Ogden");
  arm.template add_plain<double, SaintVenantKirchhoff>("Saint Venant-Kirchhoff");
  arm.template add_plain<double, NeoHookean>("neo-Hookean");
  arm.template add_plain<double, Ogden>("Ogden");
  arm.template add_plain<float, Ogden>("Ogden, float");
  for (double above : {0.005, 0.01, 0.02, 0.05})
    arm.template add_adaptive<SaintVenantKirchhoff>("Saint Venant-Kirchhoff", StrainNorm{}, above);
  for (double above : {0.01, 0.03, 0.1})
    arm.template add_adaptive<NeoHookean>("neo-Hookean", StrainNorm{}, above);
  for (double above : {0.01, 0.03, 0.1}) {
    arm.template add_cheapest<NeoHookean>("neo-Hookean", above);
    arm.template add_cheapest<SaintVenantKirchhoff, NeoHookean>(
        "Saint Venant-Kirchhoff, neo-Hookean", above);
  }
  arm.hold_contest(problem, options);
}

/// Under Corotated, which is Hooke's law where nothing turns.
template <Element E>
void swing_corotated(std::string const& problem, Options const& options) {
  arm::Arm<E, Corotated> arm(options, "Corotated");
  arm.template add_plain<double, Hooke>("Hooke");
  arm.template add_plain<double, SaintVenantKirchhoff>("Saint Venant-Kirchhoff");
  arm.template add_plain<double, Corotated>("Corotated");
  arm.template add_plain<float, Corotated>("Corotated, float");
  for (double above : {0.005, 0.02, 0.05})
    arm.template add_adaptive<Hooke>("Hooke", largest(StrainNorm{}, Rotation{}), above);
  for (double above : {0.005, 0.02, 0.05})
    arm.template add_adaptive<SaintVenantKirchhoff>("Saint Venant-Kirchhoff", StrainNorm{}, above);
  arm.hold_contest(problem, options);
}

}  // namespace pliant::bench

#include <memory>

#include "verification/support/compositions.hpp"
#include "work_precision/motion.hpp"

// A large plate that is hit at a corner, damped: what the waves have not reached or have left is at rest. Errors are
// those of the displacements of all nodes, beside Ogden's law everywhere, nothing asleep, in half the steps on the
// same mesh.
namespace pliant::bench {

namespace plate {

inline constexpr Elastic material{.young = 2e6, .poisson = 0.3, .density = 1e3};
inline constexpr double side = 2, struck = 0.3, speed = 6;  // m, m, m/s
inline constexpr double damping = 80;                       // 1/s

template <template <class> class L, class Q = Gauss<2>>
using Law = Formulation<Quad4, Q, L>;

template <class T, class... Fs>
auto make(int cells, int threads) {
  Body body{backend<T>(threads), mesh::rectangle({.size = {side, side}, .cells = {cells, cells}}),
            material, Group<Fs>{}...};
  for (char const* held : {"left", "bottom"}) body.clamp(body.mesh().boundary(held));
  body.set_damping(damping);
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) {
    auto const& p = body.mesh().nodes[i];
    double const away = std::hypot(side - p[0], side - p[1]) / struck;
    double const fades = square(std::max(0.0, 1 - square(away)));
    v[i] = {-speed * fades, -speed * fades};
  }
  body.set_velocities(v);
  return body;
}

class Blow {
 public:
  Blow(Options const& options, int cells) : options_(options), cells_(cells) {
    auto body = make<double, Law<Ogden>>(cells, options.threads);
    *truth_ = history(samples_, body, samples_.explicit_steps(0.4),
                      [](auto const& now) { return now.displacements(); });
  }
  template <class T, class... Fs, class Begin>
  void add(char const* kind, std::string const& name, Begin const& begin) {
    contestants_.push_back(moving(
        kind, name, cells_, samples_,
        [cells = cells_, threads = options_.threads] { return make<T, Fs...>(cells, threads); },
        begin,
        [truth = truth_](auto const& body, int sample, Apart& apart) {
          auto const u = body.displacements();
          auto const& v = (*truth)[static_cast<std::size_t>(sample)];
          for (std::size_t i = 0; i < u.size(); ++i) apart.add(u[i], v[i]);
        }));
  }
  void run() {
    using Cheap = Law<NeoHookean>;
    using Costly = Law<Ogden>;
    auto const awake = samples_.explicit_steps(0.8);
    add<double, Costly>("one law", "Ogden", awake);
    add<float, Costly>("one law", "Ogden, float", awake);
    add<double, Law<Ogden, OnePoint>>("one law", "Ogden, OnePoint", awake);
    add<double, Cheap>("one law", "neo-Hookean", awake);
    for (double share : {1e-1, 1e-2, 1e-3, 1e-4}) {
      char text[64];
      auto const rest = sleep({.below = share * speed, .for_steps = 32});
      std::snprintf(text, sizeof text, "sleep below %g of the blow", share);
      auto const begin = samples_.explicit_steps(0.8, [=] { return Adaptation{rest}.every(16); });
      add<double, Costly>("sleep", std::string("Ogden, ") + text, begin);
      if (share == 1e-3) add<float, Costly>("sleep", std::string("Ogden, float, ") + text, begin);
      add<double, Cheap, Costly>(
          "sleep and laws", std::string("neo-Hookean, Ogden above 0.02, ") + text,
          samples_.explicit_steps(0.8, [=] {
            return Adaptation{when<Cheap>(StrainNorm{}).above(0.02).template become<Costly>(),
                              when<Costly>(StrainNorm{}).below(0.01).template become<Cheap>(), rest}
                .every(16);
          }));
    }
    add<double, Cheap, Costly>(
        "laws", "neo-Hookean, Ogden above 0.02", samples_.explicit_steps(0.8, [] {
          return Adaptation{when<Cheap>(StrainNorm{}).above(0.02).template become<Costly>(),
                            when<Costly>(StrainNorm{}).below(0.01).template become<Cheap>()}
              .every(16);
        }));
    hold_contest("corner-hit plate, " + std::to_string(cells_ * cells_) + " Quad4", contestants_,
                 options_);
  }

 private:
  Options options_;
  int cells_;
  Samples samples_{10, 0.004};
  std::shared_ptr<std::vector<std::vector<Point<2>>>> truth_ =
      std::make_shared<std::vector<std::vector<Point<2>>>>();
  std::vector<Contestant> contestants_;
};

}  // namespace plate
}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::Options const options(argc, argv);
  for (int cells : options.quick ? std::vector{64} : std::vector{128})
    pliant::bench::plate::Blow(options, cells).run();
}

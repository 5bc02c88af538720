#include <memory>

#include "verification/support/compositions.hpp"
#include "work_precision/motion.hpp"

// A slender beam, clamped at its left end, falls and swings under its weight, with large rotations. Errors are those
// of the history of its tip, beside a mesh of Quad9 finer than all others.
namespace pliant::bench {

using verification::Full;

namespace beam {

inline constexpr Elastic material{.young = 3e6, .poisson = 0.3, .density = 1e3};
inline constexpr double length = 1, height = 0.1;  // m

template <class T, class F, class... Others>
auto make(int n, int threads) {
  using E = typename F::element;
  Body body{backend<T>(threads),
            mesh::rectangle<E>({.size = {length, height}, .cells = {10 * n, n}}), material,
            Group<F>{}, Group<Others>{}...};
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -9.81});
  return body;
}
/// Of all meshes with an even number of cells across, a corner else.
template <class TheBody>
Point<2> tip(TheBody const& body) {
  return body.displacements()[node_at(body.mesh(), {length, 0})];
}

class Swing {
  template <template <class> class L, Element E, class Q = Full<E>>
  using Of = Formulation<E, Q, L>;
  template <Element E, class Q = Full<E>>
  using F = Of<SaintVenantKirchhoff, E, Q>;

 public:
  explicit Swing(Options const& options) : options_(options) {
    auto const found = [&](int n) {
      auto body = make<double, F<Quad9>>(n, options_.threads);
      return history(samples_, body, samples_.explicit_steps(0.5),
                     [](auto const& now) { return tip(now); });
    };
    int const n = options.quick ? 4 : 8;
    *truth_ = found(n);
    auto const coarse = found(n / 2);
    Apart apart;
    for (std::size_t k = 0; k < coarse.size(); ++k) apart.add(coarse[k], (*truth_)[k]);
    std::fprintf(stderr, "bending beam: half as many cells of Quad9 are off by %.1e\n",
                 apart.relative());
  }
  template <class T, class... Fs, class Begin>
  void add(char const* kind, std::string const& name, int n, Begin const& begin) {
    contestants_.push_back(moving(
        kind, name, n, samples_,
        [n, threads = options_.threads] { return make<T, Fs...>(n, threads); }, begin,
        [truth = truth_](auto const& body, int sample, Apart& apart) {
          apart.add(tip(body), (*truth)[static_cast<std::size_t>(sample)]);
        }));
  }
  void run() {
    auto const steps = samples_.explicit_steps(0.9);
    auto const meshes = options_.quick ? std::vector{1, 2} : std::vector{1, 2, 4, 8};
    for (int n : meshes) {
      add<double, F<Tri3>>("global steps", "Tri3", n, steps);
      add<double, F<Quad4>>("global steps", "Quad4", n, steps);
      add<double, F<Quad4, OnePoint>>("global steps", "Quad4, OnePoint", n, steps);
      add<float, F<Quad4, OnePoint>>("global steps", "Quad4, OnePoint, float", n, steps);
      add<double, F<Quad4, OnePoint>>("global steps", "Quad4, OnePoint, safety 0.45", n,
                                      samples_.explicit_steps(0.45));
      add_laws(n);
      if (n > 2) continue;
      add<double, F<Tri6>>("global steps", "Tri6", n, steps);
      add<double, F<Quad9>>("global steps", "Quad9", n, steps);
      for (int of_a_sample : {4, 16}) add_implicit(n, of_a_sample);
      add_refinement(n);
    }
    hold_contest("bending beam", contestants_, options_);
  }

 private:
  void add_laws(int n) {
    using Straight = Of<Hooke, Quad4>;
    add<double, Straight, F<Quad4>>("laws", "Quad4, Hooke, Saint Venant-Kirchhoff above 0.02", n,
                                    samples_.explicit_steps(0.9, [] {
                                      return Adaptation{
                                          when<Straight>(largest(StrainNorm{}, Rotation{}))
                                              .above(0.02)
                                              .template become<F<Quad4>>(),
                                          when<F<Quad4>>(largest(StrainNorm{}, Rotation{}))
                                              .below(0.01)
                                              .template become<Straight>()};
                                    }));
  }
  /// Steps of Quad9 as long as a share of a sample.
  void add_implicit([[maybe_unused]] int n, [[maybe_unused]] int of_a_sample) {
#if !defined(__CUDACC__)
    add<double, F<Quad9>>(
        "implicit", "Quad9, Newmark, " + std::to_string(of_a_sample) + " a sample", n,
        [apart = samples_.apart, of_a_sample](auto&) {
          return [of_a_sample, step = Implicit{Newmark{}, {.step = apart / of_a_sample}}](
                     auto& b) mutable { step(b, of_a_sample); };
        });
#endif
  }
  /// Where the estimate says, as it moves: by the step of the smallest elements, or each element by its own.
  void add_refinement(int n) {
    using G = F<Quad4>;
    auto const looks = [](int apart) {
      return Adaptation{when<G>(RecoveredStress{}).above(2e-2).refine({.max_level = 2})}.every(
          apart);
    };
    add<double, G>("refinement", "Quad4, refined as it moves", n,
                   samples_.explicit_steps(0.9 / 4, [=] { return looks(256); }));
    add<double, G>("refinement", "Quad4, refined as it moves, local steps", n,
                   [=, samples = samples_](auto& body) {
                     int const steps = samples.steps_within(0.8 * stable_step(body));
                     LocalSteps step{{.macro_step = samples.apart / steps}};
                     return [steps, step, adapt = looks(64)](auto& b) mutable {
                       for (int k = 0; k < steps; ++k) {
                         step(b, 1);
                         adapt(b);
                       }
                     };
                   });
  }

  Options options_;
  Samples samples_{24, 0.05};
  std::shared_ptr<std::vector<Point<2>>> truth_ = std::make_shared<std::vector<Point<2>>>();
  std::vector<Contestant> contestants_;
};

}  // namespace beam
}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::beam::Swing(pliant::bench::Options(argc, argv)).run();
}

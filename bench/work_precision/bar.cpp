#include "verification/support/compositions.hpp"
#include "work_precision/motion.hpp"

// A bar that flies into itself: its first tenth moves, the rest stands still. Without a pull across, waves in it are
// those of a string, whose displacements d'Alembert gives: errors are theirs at all nodes, beside the exact ones.
namespace pliant::bench {

using verification::Full;

namespace bar {

inline constexpr Elastic material{.young = 1e6, .poisson = 0, .density = 1e3};
inline constexpr double length = 1, struck = 0.1, speed = 1;  // m, m, m/s
inline double const sound = std::sqrt(material.young / material.density);
inline constexpr int rows = 4;  // cells across

/// ∫ of the first velocity from the middle of a period: both ends are free, so that it goes on even and periodic.
inline double integral(double x) {
  double const periods = std::floor(x / (2 * length) + 0.5), s = x - 2 * length * periods;
  return speed * (2 * struck * periods + std::clamp(s, -struck, struck));
}
inline double displacement(double x, double time) {
  return (integral(x + sound * time) - integral(x - sound * time)) / (2 * sound);
}

template <class T, class F>
auto make(int n, int threads) {
  using E = typename F::element;
  double const height = rows * length / n;
  auto const mesh = mesh::rectangle<E>({.size = {length, height}, .cells = {n, rows}});
  Body body{backend<T>(threads), mesh, material, Group<F>{}};
  for (char const* side : {"bottom", "top"}) body.hold(body.mesh().boundary(side), 2);  // along y
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) {
    double const beyond = mesh.nodes[i][0] - struck;
    v[i] = {std::abs(beyond) < 1e-9 ? speed / 2 : beyond < 0 ? speed : 0, 0};
  }
  body.set_velocities(v);
  return body;
}

class Impact {
 public:
  explicit Impact(Options const& options) : options_(options) {}

  template <class T, class F, class Begin>
  void add(char const* kind, std::string const& name, int n, Begin const& begin) {
    contestants_.push_back(moving(
        kind, name, n, samples, [n, threads = options_.threads] { return make<T, F>(n, threads); },
        begin,
        [](auto const& body, int sample, Apart& apart) {
          double const time = samples.apart * (sample + 1);
          auto const u = body.displacements();
          for (std::size_t i = 0; i < u.size(); ++i)
            apart.add(u[i], Point<2>{displacement(body.mesh().nodes[i][0], time), 0});
        }));
  }
  template <Element E, class Q = Full<E>>
  void add_meshes(std::string const& name) {
    for (int n : meshes())
      if (E::degree == 1 || n > meshes().front())
        add<double, Formulation<E, Q, Hooke>>("global steps", name, n / E::degree,
                                              samples.explicit_steps(0.9));
  }
  void run() {
    using F = Formulation<Quad4, Full<Quad4>, Hooke>;
    add_meshes<Tri3>("Tri3");
    add_meshes<Quad4>("Quad4");
    add_meshes<Quad4, OnePoint>("Quad4, OnePoint");
    add_meshes<Tri6>("Tri6");
    add_meshes<Quad9>("Quad9");
    for (int n : meshes()) {
      add<float, F>("global steps", "Quad4, float", n, samples.explicit_steps(0.9));
      add<double, F>("global steps", "Quad4, safety 0.45", n, samples.explicit_steps(0.45));
      for (double share : {1e-1, 1e-2, 1e-3}) {
        char text[48];
        std::snprintf(text, sizeof text, "Quad4, sleep below %g of the blow", share);
        add<double, F>("sleep", text, n, samples.explicit_steps(0.9, [share] {
          return Adaptation{sleep({.below = share * speed, .for_steps = 16})}.every(8);
        }));
      }
#if !defined(__CUDACC__)
      if (n > 400) continue;
      add<double, F>("implicit", "Quad4, Newmark, a cell a step", n, [n](auto&) {
        int const steps = samples.steps_within(length / n / sound);
        return [steps, step = Implicit{Newmark{}, {.step = samples.apart / steps}}](
                   auto& b) mutable { step(b, steps); };
      });
#endif
    }
    hold_contest("impact on a bar", contestants_, options_);
  }

 private:
  /// Until the first front is close to the far end.
  inline static Samples const samples{8, 0.1 * length / sound};

  std::vector<int> meshes() const {
    return options_.quick ? std::vector{100, 200} : std::vector{100, 200, 400, 800, 1600};
  }

  Options options_;
  std::vector<Contestant> contestants_;
};

}  // namespace bar
}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::bar::Impact(pliant::bench::Options(argc, argv)).run();
}
